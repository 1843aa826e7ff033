#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace atrium::renderer {

/// Limits for the cameras that colour the visible side of a person. An eye sees surfaces that face
/// it, and `choose_cameras` prefers the cameras next to the eye's direction. Cameras on the far
/// side contribute almost nothing, so their textures need not be decoded.
struct NeededCamerasOptions {
    /// Maximum angle between the directions from the person to the camera and to the eye.
    double max_angle_deg = 90.0;
    /// Number of cameras nearest to an eye that are always needed.
    std::size_t least_num = 4;
};

/// Returns which cameras are needed for a person within `bounds_site`, seen from the given eyes.
/// All cameras without an eye, without bounds, or if an eye is inside the bounds.
std::vector<bool> needed_cameras(std::span<const Eigen::Vector3f> centres_site,
                                 const Eigen::AlignedBox3f& bounds_site,
                                 std::span<const Eigen::Vector3f> eyes_site,
                                 const NeededCamerasOptions& options = {});

}  // namespace atrium::renderer
