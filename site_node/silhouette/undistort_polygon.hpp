#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::silhouette {

/// Undistorts a closed polygon. Edges that the lens bends by more than about 0.1 px get further
/// vertices. `edges[k]` becomes the index of the input edge that output edge k (from vertex k to
/// the next) is a part of. Returns false, with the outputs undefined, if a point has no undistorted
/// position.
bool undistort_polygon(std::span<const Eigen::Vector2d> distorted_px,
                       const geometry::PinholeCamera& intrinsics,
                       std::vector<Eigen::Vector2d>& undistorted_px,
                       std::vector<std::uint32_t>& edges);

}  // namespace atrium::silhouette
