#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace atrium::geometry {

/// Angles about x, then y, then z of the world [degrees], within +-180, +-90 and +-180. At a pitch
/// of +-90 degrees, where roll and yaw turn about the same axis, the roll is 0.
Eigen::Vector3d roll_pitch_yaw_deg(const Eigen::Quaterniond& rotation);

/// Rotation by these angles [degrees] about x, then y, then z of the world.
Eigen::Quaterniond rotation_of_roll_pitch_yaw(const Eigen::Vector3d& angles_deg);

}  // namespace atrium::geometry
