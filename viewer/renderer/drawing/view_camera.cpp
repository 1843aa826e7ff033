#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::renderer {

Eigen::Matrix4d view_from_world(const ViewCamera& camera) {
    const Eigen::Vector3d forward = (camera.target_m - camera.position_m).normalized();
    const Eigen::Vector3d up =
        std::abs(forward.z()) > 0.9999 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d right = forward.cross(up).normalized();
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.block<1, 3>(0, 0) = right.transpose();
    m.block<1, 3>(1, 0) = right.cross(forward).transpose();
    m.block<1, 3>(2, 0) = -forward.transpose();
    m.topRightCorner<3, 1>() = -(m.topLeftCorner<3, 3>() * camera.position_m);
    return m;
}

Eigen::Matrix4d clip_from_view(const ViewCamera& camera, double aspect) {
    const double f = 1.0 / std::tan(camera.fov_deg * std::numbers::pi / 360.0);
    const double n = camera.near_m;
    const double r = camera.far_m;
    Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
    m(0, 0) = f / aspect;
    m(1, 1) = f;
    m(2, 2) = (r + n) / (n - r);
    m(2, 3) = 2.0 * r * n / (n - r);
    m(3, 2) = -1.0;
    return m;
}

Eigen::Vector3d EyeView::eye_world() const {
    return -(view_from_world.topLeftCorner<3, 3>().transpose() *
             view_from_world.topRightCorner<3, 1>());
}

EyeView eye_of(const ViewCamera& camera, int width, int height) {
    EyeView eye;
    eye.view_from_world = view_from_world(camera);
    eye.clip_from_view = clip_from_view(camera, static_cast<double>(width) / height);
    eye.part_px = {0, 0, width, height};
    return eye;
}

Eigen::Vector2d project_px(const ViewCamera& camera,
                           const Eigen::Vector3d& p_world,
                           int width,
                           int height) {
    const Eigen::Vector4d clip = clip_from_view(camera, static_cast<double>(width) / height) *
                                 view_from_world(camera) * p_world.homogeneous();
    const Eigen::Vector2d ndc = clip.head<2>() / clip.w();
    return {(ndc.x() + 1.0) * 0.5 * width - 0.5, (1.0 - ndc.y()) * 0.5 * height - 0.5};
}

double seen_radius_px(const View& view, const Eigen::Vector3d& centre_world, double radius_m) {
    const Eigen::Matrix4d& m = view.clip_from_world;
    const Eigen::Vector4d centre = centre_world.homogeneous();
    for (const double side : {-1.0, 1.0}) {
        for (Eigen::Index i = 0; i < 3; ++i) {
            const Eigen::RowVector4d plane = m.row(3) + side * m.row(i);
            if (plane * centre < -radius_m * plane.head<3>().norm()) return 0.0;
        }
    }
    const double depth = m.row(3) * centre;
    const double focal_px = 0.5 * view.height_px * m.row(1).head<3>().norm();
    return radius_m * focal_px / std::max(depth - radius_m, 1e-3);
}

}  // namespace atrium::renderer
