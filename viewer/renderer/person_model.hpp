#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/image.hpp"
#include "viewer/renderer/colour_evening.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::renderer {

/// What one camera saw of a person.
struct CameraPicture {
    geometry::CalibratedCamera camera;
    image::PixelRect crop_px;  // part of the camera's distorted picture that `rgba` shows
    int width = 0;             // of `rgba`, at any resolution
    int height = 0;
    std::vector<std::uint8_t> rgba;  // rows from the top; alpha 255 on the person, 0 elsewhere
};

/// A person ready to be textured from any viewpoint: all that does not depend on the viewpoint.
struct PersonModel {
    struct Camera {
        /// Where what is in its layer was seen.
        geometry::PinholeCamera intrinsics;
        geometry::RigidTransform camera_from_site;
        image::PixelRect crop_px;  // of the distorted picture; fills the layer from `low_st` on
        Eigen::Vector2f low_st = Eigen::Vector2f::Zero();  // texture coordinates of its corners
        Eigen::Vector2f high_st = Eigen::Vector2f::Ones();

        Eigen::Vector3f centre_site = Eigen::Vector3f::Zero();
        /// Per vertex (s z, t z, z): s, t are texture coordinates in the camera's layer, z is the
        /// depth. Linear in the position (but for the lens distortion), so that the perspective
        /// interpolation of triangles is right.
        std::vector<Eigen::Vector3f> layer_coordinates;
        /// Per vertex, in [0, 1]: 0 where the camera does not see it (no face there faces it,
        /// hidden behind another part, outside the mask). Continuous.
        std::vector<float> quality;
        /// Per triangle, in [0, 1]: 0 where it faces away or is edge-on, as the faces are that the
        /// camera's own silhouette made; 1 where it does not graze.
        std::vector<float> facing;
    };

    std::vector<Eigen::Vector3f> vertices_site;
    Eigen::AlignedBox3f bounds_site;       // of the vertices
    std::vector<Eigen::Vector3f> normals;  // per vertex, unit, smoothed
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Camera> cameras;
    std::vector<Eigen::Vector3f> fallback;  // per vertex, in [0, 1]: for where no camera sees it
    int layer_width = 0;                    // one layer per camera, all of the same size
    int layer_height = 0;
    std::vector<std::uint8_t> layers;  // RGBA, colour multiplied by alpha, which is small at
                                       // the person's outline and 0 outside
};

struct PersonModelOptions {
    int depth_picture_px = 192;    // long side of the pictures that decide what hides what
    double hidden_bias_m = 0.012;  // a surface this far behind another one is still not hidden
    double hidden_soft_m = 0.02;   // over this further distance it fades out
    double cos_min = 0.03;         // a camera that sees a face at a more grazing angle is not
    double cos_full = 0.2;         // used; from here on fully
    ColourEveningOptions colour_evening;
};

/// Memory that `build_person_model` uses again.
struct PersonModelScratch {
    PersonModelScratch();
    PersonModelScratch(PersonModelScratch&&) noexcept;
    PersonModelScratch& operator=(PersonModelScratch&&) noexcept;
    ~PersonModelScratch();

    ColourEveningScratch colour_evening;
    struct Parts;
    std::unique_ptr<Parts> parts;
};

/// Fills `out`, whose memory is used again. Pictures that are empty are left out. The mesh's
/// indices must be valid.
void build_person_model(const geometry::TriangleMesh& mesh_site,
                        std::span<const CameraPicture> pictures,
                        const PersonModelOptions& options,
                        PersonModelScratch& scratch,
                        PersonModel& out);

}  // namespace atrium::renderer
