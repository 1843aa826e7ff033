#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

/// How far the silhouettes of a rig agree with its calibration, from epipolar tangents. Pure
/// functions without threads, for sites and tools.
namespace atrium::coherence {

/// The convex hull of all silhouettes in one picture.
struct SilhouetteHull {
    bool has_picture = false;  // false: the camera delivered nothing at this instant
    std::vector<Eigen::Vector2d>
        points;  // undistorted [px], in order around; empty: nobody is seen
    std::vector<std::uint8_t> at_border;  // per point: the picture may cut the silhouette there
};

/// Makes the hull of the contours of one picture (undistorted [px]). `margin_px`: points that are
/// nearer to the picture's border are `at_border`.
SilhouetteHull hull_of(std::span<const std::vector<Eigen::Vector2d>> contours,
                       const geometry::PinholeCamera& camera,
                       double margin_px = 2.5);

/// How far a point lies outside a hull [px]; negative inside. `hull` must have three points.
double distance_outside_px(const SilhouetteHull& hull, const Eigen::Vector2d& px);

}  // namespace atrium::coherence
