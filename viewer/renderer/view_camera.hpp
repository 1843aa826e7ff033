#pragma once

#include <Eigen/Core>

namespace atrium::renderer {

/// From where the viewer looks into the world.
struct ViewCamera {
    Eigen::Vector3d position_m = {3.0, -3.0, 1.7};  // world
    Eigen::Vector3d target_m = {0.0, 0.0, 1.0};     // world; differs from `position_m`
    double fov_deg = 45.0;                          // vertical opening angle
    double near_m = 0.05;
    double far_m = 100.0;

    bool operator==(const ViewCamera&) const = default;
};

/// GL's view matrix: the camera looks along -Z with +Y up. Where the view is straight up or down,
/// world +Y takes the place of the up direction.
Eigen::Matrix4d view_from_world(const ViewCamera& camera);

/// GL's projection into clip space; `aspect` is width / height.
Eigen::Matrix4d clip_from_view(const ViewCamera& camera, double aspect);

/// Pixel (x right, y down, pixel centres at integers) at which a picture of the given size shows
/// `p_world`, which must lie in front of the camera.
Eigen::Vector2d project_px(const ViewCamera& camera,
                           const Eigen::Vector3d& p_world,
                           int width,
                           int height);

/// What the shaders want of it.
struct View {
    Eigen::Matrix4d clip_from_world;
    Eigen::Vector3d eye_world;
};

}  // namespace atrium::renderer
