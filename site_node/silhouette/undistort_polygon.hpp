#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::silhouette {

/// Undistorts a closed polygon. Adds vertices to edges that the lens bends by more than about 0.1
/// px. Sets `edges[k]` to the input edge that contains output edge k (from vertex k to the next).
/// Returns false, with undefined outputs, if a point has no undistorted position.
bool undistort_polygon(std::span<const Eigen::Vector2d> distorted_px,
                       const geometry::PinholeCamera& intrinsics,
                       std::vector<Eigen::Vector2d>& undistorted_px,
                       std::vector<std::uint32_t>& edges);

}  // namespace atrium::silhouette
