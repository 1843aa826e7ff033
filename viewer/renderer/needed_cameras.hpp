#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace atrium::renderer {

/// Cameras whose pictures colour what is seen of a person. An eye sees surfaces that face it, and
/// `choose_cameras` prefers the cameras next to the eye's direction: those on the far side of the
/// person colour next to nothing, and what they saw need not be decoded.
struct NeededCamerasOptions {
    /// Between the directions from the person to the camera and to the eye; a camera beyond it is
    /// not needed.
    double max_angle_deg = 90.0;
    /// The cameras next to an eye are needed wherever they are.
    std::size_t least_num = 4;
};

/// Which of the cameras, given by their centres, are needed for a person within `bounds_site` and
/// eyes at these places: all of them without an eye, without bounds, or with an eye in the bounds.
std::vector<bool> needed_cameras(std::span<const Eigen::Vector3f> centres_site,
                                 const Eigen::AlignedBox3f& bounds_site,
                                 std::span<const Eigen::Vector3f> eyes_site,
                                 const NeededCamerasOptions& options = {});

}  // namespace atrium::renderer
