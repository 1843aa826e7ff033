#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/flow/dense_flow.hpp"
#include "site_node/motion/depth_map.hpp"
#include "site_node/motion/motion_options.hpp"
#include "site_node/motion/motion_picture.hpp"
#include "site_node/motion/surface_points.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::motion {

/// Equations for the displacement of a point: `lhs * displacement = rhs` [px^2/m^2, px^2/m].
struct PointEquations {
    Eigen::Matrix3f lhs = Eigen::Matrix3f::Zero();
    Eigen::Vector3f rhs = Eigen::Vector3f::Zero();
    float seen = 0.0F;       // weight of the cameras that see the point
    float explained = 0.0F;  // of that, what agrees with the displacement
};

/// What two successive pictures of one camera say about the motion of a surface.
class CameraEvidence {
public:
    CameraEvidence(const geometry::CalibratedCamera& camera, const SurfaceMotionOptions& options);

    /// Finds the flow between the pictures and the points that the camera sees. An empty picture:
    /// the camera says nothing.
    void look(const geometry::TriangleMesh& mesh_site,
              const SurfacePoints& surface,
              const MotionPicture& now,
              const MotionPicture& before);

    /// Forgets the last look.
    void clear() { sights_.clear(), first_of_cell_.clear(); }

    /// Adds the equations of the points of a cell to `equations`, one per point of the cell, with
    /// `displacements` [m] as the present estimate. `scale_px`: a flow vector this far from the
    /// estimate counts a quarter.
    void add_flow(std::size_t cell,
                  float scale_px,
                  std::span<const Eigen::Vector3d> displacements,
                  std::span<PointEquations> equations) const;
    /// The same by comparing patches at the places that the estimate predicts.
    void add_patches(std::size_t cell,
                     const SurfacePoints& surface,
                     std::span<const Eigen::Vector3d> displacements,
                     std::span<PointEquations> equations) const;

    std::size_t num_seen() const { return sights_.size(); }

private:
    static constexpr int kHalf = 3;  // a patch reaches this many pixels to each side
    static constexpr int kSide = 2 * kHalf + 1;
    static constexpr int kStride = kSide + 1;  // for SIMD
    using Pixels = std::array<float, static_cast<std::size_t>(kSide) * kStride>;

    // The pixels around a point. Pixels that do not belong to its surface are 0 everywhere.
    struct Patch {
        Pixels gradient_x{};  // without their mean, so that a change of brightness does not count
        Pixels gradient_y{};
        Pixels value{};
        Pixels is_valid{};  // 0 or 1
    };
    struct Sight {                // of a point
        std::uint32_t point = 0;  // index within its cell
        int column = 0;           // of the patch's first pixel
        int row = 0;
        float num_valid = 0.0F;
        float weight = 0.0F;
        Eigen::Vector2f place_px;  // of the point in the canvas
        Eigen::Vector2f flow_px;   // its displacement since the picture before
        Eigen::Matrix<float, 2, 3> px_per_m;
        Eigen::Matrix2f trust;  // share of a flow vector that the patch's texture supports
        Eigen::Matrix2f step;   // from gradients times differences to pixels
        Patch patch;
    };

    void find_flow(const MotionPicture& now, const MotionPicture& before);
    void see(const SurfacePoint& point, std::uint32_t index);
    bool take_patch(float inverse_depth, Sight& sight) const;
    bool compare(const Sight& sight,
                 const Eigen::Vector2f& moved_px,
                 Eigen::Vector2f& step_px,
                 float& difference_sq) const;
    Eigen::Vector2d canvas_px(const Eigen::Vector3d& p_camera) const;

    geometry::CalibratedCamera camera_;
    SurfaceMotionOptions options_;
    Eigen::Matrix3d rotation_;
    Eigen::Vector3d centre_site_;
    flow::DenseFlow dense_flow_;
    image::PixelRect canvas_;  // holds both pictures [px of a quarter of the resolution]
    image::Plane now_;
    image::Plane before_;
    std::vector<float> before_values_;            // of before_
    const MotionPicture* picture_now_ = nullptr;  // only during `look`
    flow::FlowField flow_;
    DepthMap depths_;
    std::vector<Sight> sights_;                 // ordered by cell
    std::vector<std::uint32_t> first_of_cell_;  // one per cell, plus the end
};

}  // namespace atrium::motion
