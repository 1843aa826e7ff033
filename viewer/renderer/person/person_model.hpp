#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/image.hpp"
#include "viewer/renderer/person/gain_compensation.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::renderer {

/// Picture of a person from one camera.
struct CameraPicture {
    geometry::CalibratedCamera camera;
    image::PixelRect crop_px;  // part of the camera's distorted picture that `rgba` shows
    int width = 0;             // size of `rgba`, at any resolution
    int height = 0;
    std::vector<std::uint8_t> rgba;  // top row first; alpha 255 on the person, 0 elsewhere
};

/// A person ready to be textured from any viewpoint. Holds all that does not depend on the
/// viewpoint.
struct PersonModel {
    struct Camera {
        /// Calibration of the camera.
        geometry::PinholeCamera intrinsics;
        geometry::RigidTransform camera_from_site;
        /// Part of the distorted picture. It fills the layer from `low_st` to `high_st`.
        image::PixelRect crop_px;
        /// Texture coordinates of the corners of `crop_px`.
        Eigen::Vector2f low_st = Eigen::Vector2f::Zero();
        Eigen::Vector2f high_st = Eigen::Vector2f::Ones();

        Eigen::Vector3f centre_site = Eigen::Vector3f::Zero();
        /// Per vertex (s z, t z, z): s, t are texture coordinates in the camera's layer, z is the
        /// depth. Linear in the position except for the lens distortion, so perspective
        /// interpolation over a triangle is correct.
        std::vector<Eigen::Vector3f> layer_coordinates;
        /// Per vertex, in [0, 1]: 0 if the camera does not see it (no face there faces the camera,
        /// hidden by another part, or outside the mask). Continuous.
        std::vector<float> quality;
        /// Per triangle, in [0, 1]: 0 if it faces away or is edge-on, like the faces that the
        /// camera's own silhouette cut. 1 if it is not at a grazing angle.
        std::vector<float> facing;
    };

    std::vector<Eigen::Vector3f> vertices_site;
    Eigen::AlignedBox3f bounds_site;       // of the vertices
    std::vector<Eigen::Vector3f> normals;  // per vertex, length 1, smoothed
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Camera> cameras;
    std::vector<Eigen::Vector3f> fallback;  // per vertex, in [0, 1]; used where no camera sees it
    int layer_width = 0;                    // one layer per camera, all of the same size
    int layer_height = 0;
    /// RGBA, colour multiplied by alpha. Alpha is small at the person's outline and 0 outside.
    std::vector<std::uint8_t> layers;
};

struct PersonModelOptions {
    int depth_picture_px = 192;    // long side of the depth pictures for occlusion
    double hidden_bias_m = 0.012;  // a surface this far behind another is still visible
    double hidden_soft_m = 0.02;   // distance over which it then fades out
    double cos_min = 0.03;         // below this cosine a camera does not see a face
    double cos_full = 0.2;         // from this cosine on it sees the face fully
    GainCompensationOptions gain_compensation;
};

/// Reusable memory of `build_person_model`.
struct PersonModelScratch {
    PersonModelScratch();
    PersonModelScratch(PersonModelScratch&&) noexcept;
    PersonModelScratch& operator=(PersonModelScratch&&) noexcept;
    ~PersonModelScratch();

    GainCompensationScratch gain_compensation;
    struct Parts;
    std::unique_ptr<Parts> parts;
};

/// Builds the model in `out` and reuses its memory. Skips empty pictures. The indices of the mesh
/// must be valid.
void build_person_model(const geometry::TriangleMesh& mesh_site,
                        std::span<const CameraPicture> pictures,
                        const PersonModelOptions& options,
                        PersonModelScratch& scratch,
                        PersonModel& out);

}  // namespace atrium::renderer
