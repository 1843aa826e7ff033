#pragma once

#include <Eigen/Core>

#include <array>
#include <optional>

namespace atrium::calibrate {

/// Lens of a camera that is adjusted: f, cx, cy [px], k1, k2, p1, p2, k3 as in OpenCV.
using LensValues = std::array<double, 8>;

/// Where a camera sees a point [px, distorted], and its derivatives.
struct Reprojection {
    Eigen::Vector2d px;
    Eigen::Matrix<double, 2, 3> by_point;  // in the camera's frame [px/m]
    Eigen::Matrix<double, 2, 8> by_lens;   // in the order of LensValues
};

/// Empty behind the camera.
std::optional<Reprojection> reproject(const LensValues& lens, const Eigen::Vector3d& point_camera);

/// The same without derivatives.
std::optional<Eigen::Vector2d> project_in_camera(const LensValues& lens,
                                                 const Eigen::Vector3d& point_camera);

/// A point that is turned by a rotation vector (axis times angle [rad]).
struct TurnedPoint {
    Eigen::Vector3d point;
    Eigen::Matrix3d rotation;
    Eigen::Matrix3d by_vector;
};
TurnedPoint turn_by(const Eigen::Vector3d& rotation_vector, const Eigen::Vector3d& point);

/// A point that is turned by a unit quaternion x, y, z, w, whose four values are taken as free.
struct QuaternionTurned {
    Eigen::Vector3d point;
    Eigen::Matrix<double, 3, 4> by_xyzw;
};
QuaternionTurned turn_by(const Eigen::Vector4d& xyzw, const Eigen::Vector3d& point);

/// The matrix of `v.cross(...)`.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

}  // namespace atrium::calibrate
