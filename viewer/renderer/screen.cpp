#include "viewer/renderer/screen.hpp"

#include <Eigen/Geometry>

#include <cassert>
#include <cmath>
#include <numbers>

namespace atrium::renderer {

Screen screen_of(const ViewCamera& camera, double aspect, double distance_m) {
    const Eigen::Matrix4d view = view_from_world(camera);
    const Eigen::Vector3d right = view.block<1, 3>(0, 0).transpose();
    const Eigen::Vector3d up = view.block<1, 3>(1, 0).transpose();
    const Eigen::Vector3d forward = -view.block<1, 3>(2, 0).transpose();
    const double half_height_m = distance_m * std::tan(camera.fov_deg * std::numbers::pi / 360.0);
    const Eigen::Vector3d lower_left =
        camera.position_m + distance_m * forward - half_height_m * (aspect * right + up);
    return {lower_left,
            lower_left + 2.0 * half_height_m * aspect * right,
            lower_left + 2.0 * half_height_m * up};
}

EyeView eye_through(const Screen& screen,
                    const Eigen::Vector3d& eye_m,
                    double near_m,
                    double far_m,
                    const image::PixelRect& part_px) {
    const Eigen::Vector3d right = screen.right();
    const Eigen::Vector3d up = screen.up();
    const Eigen::Vector3d normal = screen.normal();
    const double distance_m = normal.dot(eye_m - screen.lower_left_m);
    assert(distance_m > 0.0 && std::abs(right.dot(up)) < 1e-3);
    const double scale = near_m / distance_m;
    const double l = scale * right.dot(screen.lower_left_m - eye_m);
    const double r = scale * right.dot(screen.lower_right_m - eye_m);
    const double b = scale * up.dot(screen.lower_left_m - eye_m);
    const double t = scale * up.dot(screen.upper_left_m - eye_m);

    EyeView eye;
    eye.part_px = part_px;
    eye.view_from_world.block<1, 3>(0, 0) = right.transpose();
    eye.view_from_world.block<1, 3>(1, 0) = up.transpose();
    eye.view_from_world.block<1, 3>(2, 0) = normal.transpose();
    eye.view_from_world.topRightCorner<3, 1>() =
        -(eye.view_from_world.topLeftCorner<3, 3>() * eye_m);
    eye.clip_from_view.setZero();
    eye.clip_from_view(0, 0) = 2.0 * near_m / (r - l);
    eye.clip_from_view(0, 2) = (r + l) / (r - l);
    eye.clip_from_view(1, 1) = 2.0 * near_m / (t - b);
    eye.clip_from_view(1, 2) = (t + b) / (t - b);
    eye.clip_from_view(2, 2) = (far_m + near_m) / (near_m - far_m);
    eye.clip_from_view(2, 3) = 2.0 * far_m * near_m / (near_m - far_m);
    eye.clip_from_view(3, 2) = -1.0;
    return eye;
}

}  // namespace atrium::renderer
