#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace atrium::calibrate {

inline constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;

inline double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegreesPerRad;
}

/// The axis that is nearest to `v`, as a unit vector.
inline Eigen::Vector3d nearest_axis(const Eigen::Vector3d& v) {
    int axis = 0;
    v.cwiseAbs().maxCoeff(&axis);
    return (v[axis] > 0.0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(axis);
}

}  // namespace atrium::calibrate
