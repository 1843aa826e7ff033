#pragma once

#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Core>

namespace atrium::renderer {

/// A flat rectangle that an eye looks through, by three of its corners [m].
struct Screen {
    Eigen::Vector3d lower_left_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d lower_right_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d upper_left_m = Eigen::Vector3d::Zero();

    Eigen::Vector3d right() const { return (lower_right_m - lower_left_m).normalized(); }
    Eigen::Vector3d up() const { return (upper_left_m - lower_left_m).normalized(); }
    /// Points to the side of the eye.
    Eigen::Vector3d normal() const { return right().cross(up()); }
};

/// Screen at `distance_m` that covers the view of a camera.
Screen screen_of(const ViewCamera& camera, double aspect, double distance_m);

/// View of an eye through a screen: the frustum from the eye through the corners. The eye must be
/// before the screen, and the sides of the screen perpendicular.
///
/// After: Kooima. Generalized Perspective Projection. 2008.
EyeView eye_through(const Screen& screen,
                    const Eigen::Vector3d& eye_m,
                    double near_m,
                    double far_m,
                    const image::PixelRect& part_px);

}  // namespace atrium::renderer
