#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>

#include <optional>
#include <span>

namespace atrium::calibrate {

/// The line along which a camera sees a pixel.
struct SeenRay {
    Eigen::Vector3d start;      // the camera's centre [m]
    Eigen::Vector3d direction;  // unit length
    double focal_px;
};

/// Empty where the distortion of the lens has no inverse.
std::optional<SeenRay> seen_ray(const geometry::PinholeCamera& lens,
                                const geometry::RigidTransform& world_from_camera,
                                const Eigen::Vector2d& distorted_px);

/// The point whose distances from the rays, in pixels of their cameras, have the smallest sum of
/// squares [m]. Empty if fewer than two rays are given, if all run in about one direction, or if
/// the point lies behind a camera.
std::optional<Eigen::Vector3d> nearest_to_rays(std::span<const SeenRay> rays);

}  // namespace atrium::calibrate
