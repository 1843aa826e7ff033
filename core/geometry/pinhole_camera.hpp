#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <string>

namespace atrium::geometry {

/// Intrinsics of one camera, in pixels, pixel centres at integer coordinates (OpenCV's convention).
///
/// There are two kinds of pixel coordinates. *Undistorted* ones are linear in the ray (`u = fx x +
/// skew y + cx`, `v = fy y + cy` with x = X/Z, y = Y/Z). *Distorted* ones are positions in the
/// delivered picture.
struct PinholeCamera {
    int width = 0;
    int height = 0;
    double fx = 0.0;
    double fy = 0.0;
    double cx = 0.0;
    double cy = 0.0;
    double skew = 0.0;
    std::array<double, 5> distortion{};  // k1, k2, p1, p2, k3 as in OpenCV

    bool has_distortion() const { return distortion != std::array<double, 5>{}; }

    /// Direction (x, y, 1) in the camera frame of an undistorted pixel.
    Eigen::Vector3d ray_camera(const Eigen::Vector2d& undistorted_px) const {
        const double y = (undistorted_px.y() - cy) / fy;
        return {(undistorted_px.x() - cx - skew * y) / fx, y, 1.0};
    }

    /// Undistorted pixel of a point in the camera frame; the point must have Z > 0.
    Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const {
        const double x = p_camera.x() / p_camera.z();
        const double y = p_camera.y() / p_camera.z();
        return {fx * x + skew * y + cx, fy * y + cy};
    }

    /// Position in the delivered picture of an undistorted pixel.
    Eigen::Vector2d distort(const Eigen::Vector2d& undistorted_px) const;

    /// Inverse of `distort`, by Newton's method. Returns nullopt where the distortion model has no
    /// inverse (far outside the picture of a strongly distorting lens).
    std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& distorted_px) const;
};

/// A named camera with intrinsics and extrinsics in its site.
struct CalibratedCamera {
    std::string name;
    PinholeCamera intrinsics;
    RigidTransform camera_from_site;

    Eigen::Vector3d centre_site() const { return camera_from_site.inverse().translation; }
};

}  // namespace atrium::geometry
