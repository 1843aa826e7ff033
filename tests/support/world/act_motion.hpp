#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "tests/support/random.hpp"
#include "tests/support/world/acted_person.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

/// Motion profiles and poses that acts are made of.
namespace atrium::test {

/// Rises from 0 at `start_s` to 1 after `seconds`, with continuous velocity and acceleration.
inline double ease(double time_s, double start_s, double seconds) {
    const double t = std::clamp((time_s - start_s) / seconds, 0.0, 1.0);
    return t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}

/// Distance travelled at `speed` for `seconds`. A ramp of `ramp_s` before and one after add half
/// their length each, so the total is speed * (seconds + ramp_s).
inline double glide(double time_s, double start_s, double speed, double ramp_s, double seconds) {
    const double t = std::clamp(time_s - start_s, 0.0, seconds + 2.0 * ramp_s);
    const double up = std::min(t, ramp_s);
    const double even = std::clamp(t - ramp_s, 0.0, seconds);
    const double down = std::clamp(t - ramp_s - seconds, 0.0, ramp_s);
    return speed * (0.5 * up * up / ramp_s + even + down - 0.5 * down * down / ramp_s);
}

inline geometry::RigidTransform upright(const Eigen::Vector3d& position, double heading_rad) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ())), position};
}

inline std::string random_look(Random& random) {
    const auto looks = simulation::look_names();
    return looks[static_cast<std::size_t>(between(random, 0, static_cast<int>(looks.size()) - 1))];
}

/// Steps on the spot: the feet lift alternately by `height_m`.
inline void step(simulation::BodyPose& pose, double turns, double height_m) {
    const double swing = std::sin(2.0 * std::numbers::pi * turns);
    pose.right_leg.ankle.z() += height_m * std::max(0.0, swing);
    pose.left_leg.ankle.z() += height_m * std::max(0.0, -swing);
}

}  // namespace atrium::test
