#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/image.hpp"

#include <Eigen/Core>

#include <vector>

namespace atrium::motion {

/// Nearer to a camera nothing is seen.
constexpr double kNearestSurface_m = 0.05;

/// The distance of the nearest surface in each pixel of a camera, at the resolution of
/// MotionPicture. Keeps its memory; one per thread.
class DepthMap {
public:
    /// Draws the part `rect` [px of a quarter of the resolution]. Lens distortion bends vertices,
    /// not edges. Surfaces nearer than kNearestSurface_m are left
    /// out.
    void draw(const geometry::TriangleMesh& mesh_site,
              const geometry::CalibratedCamera& camera,
              const image::PixelRect& rect);

    /// Inverse of the depth along the camera's axis [1/m] at column x and row y of the part; 0: no
    /// surface.
    float inverse_depth(int x, int y) const {
        return inverse_depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                              static_cast<std::size_t>(x)];
    }

private:
    void draw_triangle(const Eigen::Vector3f& a,
                       const Eigen::Vector3f& b,
                       const Eigen::Vector3f& c);

    int width_ = 0;
    int height_ = 0;
    std::vector<float> inverse_depth_;
    std::vector<Eigen::Vector3f> projected_;  // column, row, inverse depth; 0: behind the camera
};

}  // namespace atrium::motion
