#include "core/geometry/roll_pitch_yaw.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::geometry {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

}  // namespace

Eigen::Vector3d roll_pitch_yaw_deg(const Eigen::Quaterniond& rotation) {
    const Eigen::Matrix3d r = rotation.toRotationMatrix();
    constexpr double kUpright = 1.0 - 1e-12;
    Eigen::Vector3d angles;
    angles.y() = std::asin(std::clamp(-r(2, 0), -1.0, 1.0));
    const bool is_locked = std::abs(r(2, 0)) > kUpright;
    angles.x() = is_locked ? 0.0 : std::atan2(r(2, 1), r(2, 2));
    angles.z() = is_locked ? std::atan2(-r(0, 1), r(1, 1)) : std::atan2(r(1, 0), r(0, 0));
    return angles / kRadPerDeg;
}

Eigen::Quaterniond rotation_of_roll_pitch_yaw(const Eigen::Vector3d& angles_deg) {
    const Eigen::Vector3d angles = kRadPerDeg * angles_deg;
    return Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
}

}  // namespace atrium::geometry
