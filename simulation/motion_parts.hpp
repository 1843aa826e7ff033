#pragma once

#include "simulation/skeleton.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

/// Building blocks of the motions.
namespace atrium::simulation {

/// Position in the loop, 0 to 1. Its sines make whole numbers of turns: every motion ends where it
/// began.
struct Phase {
    double value = 0.0;

    double sine(int turns, double offset = 0.0) const {
        return std::sin(2.0 * std::numbers::pi * (turns * value + offset));
    }
    /// Swells from 0 to 1 and back, `turns` times per loop; 0 at the start.
    double swell(int turns, double offset = 0.0) const {
        return 0.5 - 0.5 * sine(turns, offset + 0.25);
    }
    /// Rises from 0 to 1 between two phases, with continuous velocity and acceleration.
    double rise(double from, double to) const {
        const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
        return t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
    }
};

inline Eigen::Vector3d between(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double t) {
    return a + t * (b - a);
}

inline ArmPose between(const ArmPose& a, const ArmPose& b, double t) {
    return {between(a.wrist, b.wrist, t),
            between(a.elbow_towards, b.elbow_towards, t),
            between(a.fingers, b.fingers, t),
            between(a.palm, b.palm, t)};
}

/// Breathing and a weight shift by `amount_m`, common to all standing people.
inline BodyPose stand(const Phase& phase, double amount_m) {
    using Eigen::Vector3d;
    BodyPose pose;
    pose.shift += Vector3d(
        amount_m * phase.sine(1), 0.25 * amount_m * phase.sine(2, 0.1), 0.003 * phase.sine(2));
    pose.pelvis_turn = {0.0, 0.6 * amount_m * phase.sine(1), 0.04 * phase.sine(1, 0.2)};
    pose.chest_turn = {
        -0.015 * phase.sine(2), -1.2 * amount_m * phase.sine(1), 0.04 * phase.sine(1, 0.1)};
    pose.head_turn = {0.03 * phase.sine(1), 0.0, 0.12 * phase.sine(1, 0.35)};
    const double side = pose.shift.x();
    pose.right_arm.wrist += Vector3d(side, 0.02 * phase.sine(1), 0.0);
    pose.left_arm.wrist += Vector3d(-side, -0.02 * phase.sine(1), 0.0);
    return pose;
}

}  // namespace atrium::simulation
