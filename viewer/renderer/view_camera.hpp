#pragma once

#include "core/image/image.hpp"

#include <Eigen/Core>

#include <array>

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

/// What the shaders want of an eye.
struct View {
    Eigen::Matrix4d clip_from_world;
    Eigen::Vector3d eye_world;
    int height_px = 0;
};

/// What one eye sees, in a part of the renderer's picture. Its pose and projection may come from
/// outside, as those of a head-mounted display do.
struct EyeView {
    Eigen::Matrix4d view_from_world = Eigen::Matrix4d::Identity();  // looks along -Z, +Y up
    Eigen::Matrix4d clip_from_view = Eigen::Matrix4d::Identity();   // invertible
    image::PixelRect part_px;  // x to the right, y down, from the picture's upper left corner
    std::array<bool, 3> writes{true, true, true};  // which of red, green and blue

    Eigen::Vector3d eye_world() const;
    Eigen::Matrix4d clip_from_world() const { return clip_from_view * view_from_world; }
    View view() const { return {clip_from_world(), eye_world(), part_px.height}; }

    bool operator==(const EyeView&) const = default;
};

/// One eye, and all of a picture of that size.
EyeView eye_of(const ViewCamera& camera, int width, int height);

/// How large a ball is in the picture, about [px]; 0 where nothing of it is in sight, and much
/// where the eye is in it.
double seen_radius_px(const View& view, const Eigen::Vector3d& centre_world, double radius_m);

}  // namespace atrium::renderer
