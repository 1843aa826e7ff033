#pragma once

#include "core/image/image.hpp"

#include <Eigen/Core>

#include <array>

namespace atrium::renderer {

/// Viewpoint of the viewer.
struct ViewCamera {
    Eigen::Vector3d position_m = {3.0, -3.0, 1.7};  // world
    Eigen::Vector3d target_m = {0.0, 0.0, 1.0};     // world; must differ from `position_m`
    double fov_deg = 45.0;                          // vertical opening angle
    double near_m = 0.05;
    double far_m = 100.0;

    bool operator==(const ViewCamera&) const = default;
};

/// View matrix of GL: the camera looks along -Z with +Y up. If it looks straight up or down, world
/// +Y is the up direction.
Eigen::Matrix4d view_from_world(const ViewCamera& camera);

/// Projection into clip space of GL; `aspect` is width / height.
Eigen::Matrix4d clip_from_view(const ViewCamera& camera, double aspect);

/// Pixel (x right, y down, pixel centres at integers) at which a picture of the given size shows
/// `p_world`. The point must lie in front of the camera.
Eigen::Vector2d project_px(const ViewCamera& camera,
                           const Eigen::Vector3d& p_world,
                           int width,
                           int height);

/// Inputs of the shaders for one eye.
struct View {
    Eigen::Matrix4d clip_from_world;
    Eigen::Vector3d eye_world;
    int height_px = 0;
};

/// View of one eye and its part of the renderer's picture. Pose and projection may come from
/// outside, for example from a head-mounted display.
struct EyeView {
    Eigen::Matrix4d view_from_world = Eigen::Matrix4d::Identity();  // looks along -Z, +Y up
    Eigen::Matrix4d clip_from_view = Eigen::Matrix4d::Identity();   // invertible
    image::PixelRect part_px;  // x right, y down, from the upper left corner of the picture
    std::array<bool, 3> writes{true, true, true};  // red, green, blue

    Eigen::Vector3d eye_world() const;
    Eigen::Matrix4d clip_from_world() const { return clip_from_view * view_from_world; }
    View view() const { return {clip_from_world(), eye_world(), part_px.height}; }

    bool operator==(const EyeView&) const = default;
};

/// View of one eye that covers a picture of that size.
EyeView eye_of(const ViewCamera& camera, int width, int height);

/// Approximate radius of a ball in the picture [px]. 0 if it is out of sight; large if the eye is
/// inside it.
double seen_radius_px(const View& view, const Eigen::Vector3d& centre_world, double radius_m);

}  // namespace atrium::renderer
