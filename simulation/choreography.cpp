#include "simulation/choreography.hpp"

#include "simulation/motion_parts.hpp"
#include "simulation/play_motions.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace atrium::simulation {
namespace {

using Eigen::Vector3d;

constexpr std::array<std::pair<std::string_view, Motion>, 13> kMotions = {
    {{"wave", Motion::kWave},
     {"push", Motion::kPush},
     {"walk", Motion::kWalk},
     {"stroll", Motion::kStroll},
     {"sway", Motion::kSway},
     {"raise", Motion::kRaise},
     {"table_hands", Motion::kTableHands},
     {"kick", Motion::kKick},
     {"nudge", Motion::kNudge},
     {"scoop", Motion::kScoop},
     {"wade", Motion::kWade},
     {"part", Motion::kPart},
     {"carry", Motion::kCarry}}};

BodyPose wave(const Phase& phase) {
    BodyPose pose = stand(phase, 0.025);
    const double swing = phase.sine(3);
    pose.right_arm.wrist = {0.40 + 0.11 * swing, 0.16, 1.60 - 0.02 * std::abs(swing)};
    pose.right_arm.elbow_towards = {0.8, -0.35, -1.0};
    pose.right_arm.fingers = {0.45 * swing, 0.05, 1.0};
    pose.right_arm.palm = {0.0, 1.0, 0.0};
    pose.left_arm.wrist += Vector3d(0.02, 0.05 * phase.sine(1, 0.5), 0.0);
    pose.head_turn += Vector3d(0.0, 0.06, -0.1);
    return pose;
}

BodyPose push(const Phase& phase) {
    BodyPose pose = stand(phase, 0.015);
    const double thrust = phase.swell(1);
    const ArmPose drawn{.wrist = {0.24, 0.20, 1.13},
                        .elbow_towards = {0.7, -1.0, -0.6},
                        .fingers = {-0.1, 0.25, 1.0},
                        .palm = {0.0, 1.0, -0.2}};
    const ArmPose thrown{.wrist = {0.10, 0.60, 1.17},
                         .elbow_towards = {0.7, 0.0, -1.0},
                         .fingers = {-0.1, 0.12, 1.0},
                         .palm = {0.0, 1.0, -0.1}};
    pose.right_arm = between(drawn, thrown, thrust);
    pose.shift += Vector3d(0.0, 0.07 * thrust - 0.02, -0.018 * thrust);
    pose.chest_turn += Vector3d(-0.10 * thrust, 0.0, 0.42 * thrust - 0.12);
    pose.head_turn -= Vector3d(-0.06 * thrust, 0.0, 0.36 * thrust - 0.1);
    pose.left_arm.wrist += Vector3d(0.02, 0.06 - 0.16 * thrust, 0.04 * thrust);
    pose.left_leg.ankle += Vector3d(0.0, 0.13, 0.0);
    pose.right_leg.ankle += Vector3d(0.02, -0.15, 0.0);
    pose.shift.z() -= 0.03;
    return pose;
}

BodyPose walk(const Phase& phase) {
    constexpr int kSteps = 2;  // per foot and loop
    BodyPose pose;
    const auto step = [&](LegPose& leg, double offset) {
        const double lift = std::max(0.0, phase.sine(kSteps, offset));
        leg.ankle += Vector3d(-0.02, 0.10 * lift, 0.19 * lift * lift);
        leg.toe_down_rad = 0.45 * lift * lift;
    };
    step(pose.right_leg, 0.0);
    step(pose.left_leg, 0.5);
    const double swing = phase.sine(kSteps);
    pose.shift += Vector3d(-0.025 * swing, 0.0, -0.012 + 0.012 * std::abs(swing));
    pose.pelvis_turn = {0.0, 0.04 * swing, 0.10 * swing};
    pose.chest_turn = {-0.04, -0.06 * swing, -0.22 * swing};
    pose.head_turn = {0.02, 0.0, 0.10 * swing};
    const auto arm = [](ArmPose& a, double forwards) {
        a.wrist = {
            0.27, 0.04 + 0.26 * forwards, 0.93 + 0.12 * forwards * forwards + 0.05 * forwards};
        a.fingers = {0.0, 0.3 + 0.6 * forwards, -1.0};
        a.palm = {-1.0, 0.0, 0.0};
    };
    arm(pose.right_arm, -swing);
    arm(pose.left_arm, swing);
    return pose;
}

BodyPose stroll(const Phase& phase) {
    constexpr int kSteps = 3;  // per foot and loop
    constexpr double kRadiusM = 0.45;
    constexpr double kReachM = std::numbers::pi * kRadiusM / (2 * kSteps);  // of a foot, each way
    BodyPose pose;
    const auto step = [&](LegPose& leg, double offset) {
        const double turns = kSteps * phase.value + offset;
        const double t = turns - std::floor(turns);
        // on the floor, then through the air
        const double swing = Phase{t}.rise(0.5, 1.0);
        const double lift = 4.0 * swing * (1.0 - swing);
        leg.ankle.y() += t < 0.5 ? kReachM * (1.0 - 4.0 * t) : kReachM * (2.0 * swing - 1.0);
        leg.ankle.z() += 0.10 * lift;
        leg.toe_down_rad = 0.3 * lift;
    };
    step(pose.right_leg, 0.0);
    step(pose.left_leg, 0.5);
    const double ahead = phase.sine(kSteps, 0.25);  // of the right foot
    pose.shift += Vector3d(0.0, 0.0, -0.035 - 0.015 * std::abs(ahead));
    pose.pelvis_turn = {0.0, 0.0, 0.08 * ahead};
    pose.chest_turn = {-0.04, 0.0, -0.18 * ahead};
    pose.head_turn = {0.02, 0.0, 0.10 * ahead};
    const auto arm = [](ArmPose& a, double forwards) {
        a.wrist = {0.27, 0.03 + 0.20 * forwards, 0.92 + 0.08 * forwards * forwards};
        a.fingers = {0.0, 0.3 + 0.5 * forwards, -1.0};
    };
    arm(pose.right_arm, -ahead);
    arm(pose.left_arm, ahead);
    pose.facing_rad = 2.0 * std::numbers::pi * phase.value;
    pose.place = kRadiusM * Vector3d(std::cos(pose.facing_rad), std::sin(pose.facing_rad), 0.0);
    return pose;
}

BodyPose sway(const Phase& phase) {
    BodyPose pose = stand(phase, 0.06);
    const double open = phase.swell(2);
    pose.shift.z() -= 0.015;
    pose.chest_turn.z() += 0.25 * phase.sine(1, 0.25);
    const ArmPose opened{.wrist = {0.42, 0.22, 1.02},
                         .elbow_towards = {0.5, -1.0, -0.5},
                         .fingers = {0.4, 0.9, -0.1},
                         .palm = {-0.4, 0.2, 0.9}};
    pose.right_arm = between(pose.right_arm, opened, open);
    pose.left_arm = between(pose.left_arm, opened, phase.swell(2, 0.15));
    return pose;
}

BodyPose raise(const Phase& phase) {
    BodyPose pose = stand(phase, 0.015);
    const double up = phase.swell(1);
    // outwards and up, on an arc around the shoulder
    const double angle = -1.25 + 2.75 * up;
    const ArmPose arc{
        .wrist = Vector3d(0.175 + 0.51 * std::cos(angle), 0.06, 1.40 + 0.51 * std::sin(angle)),
        .elbow_towards = between({0.1, -1.0, 0.0}, {0.6, -0.8, 0.2}, up),
        .fingers = Vector3d(std::cos(angle), 0.1, std::sin(angle)),
        .palm = Vector3d(std::sin(angle), 0.15, -std::cos(angle))};
    pose.right_arm = arc;
    pose.left_arm = arc;
    pose.head_turn += Vector3d(0.12 * up, 0.0, 0.0);
    return pose;
}

BodyPose table_hands(const Phase& phase) {
    BodyPose pose;
    const Vector3d before_table(0.0, -0.70, 0.0);
    const auto reach = [&](double offset, double forwards) {
        ArmPose arm;
        const double circle_x = phase.sine(1, offset);
        const double circle_y = phase.sine(1, offset + 0.25);
        arm.wrist = {0.17 + 0.09 * circle_x,
                     -0.16 + forwards + 0.13 * circle_y,
                     0.93 + 0.05 * phase.sine(2, offset)};
        arm.elbow_towards = {1.0, -0.4, -0.7};
        arm.fingers = {-0.25 + 0.3 * circle_x, 1.0, -0.1 + 0.2 * phase.sine(2, offset + 0.2)};
        arm.palm = {-0.25, -0.1, -1.0};
        return arm;
    };
    pose.right_arm = reach(0.0, 0.02);
    pose.left_arm = reach(0.37, 0.0);
    pose.shift += before_table + Vector3d(0.01 * phase.sine(1), 0.0, -0.015);
    pose.pelvis_turn = {-0.10, 0.0, 0.0};
    pose.chest_turn = {-0.30 - 0.02 * phase.sine(1), 0.0, 0.05 * phase.sine(1)};
    pose.head_turn = {-0.20, 0.0, 0.08 * phase.sine(1, 0.2)};
    for (LegPose* leg : {&pose.right_leg, &pose.left_leg}) leg->ankle += before_table;
    return pose;
}

}  // namespace

std::optional<Motion> find_motion(std::string_view name) {
    for (const auto& [motion_name, motion] : kMotions) {
        if (motion_name == name) return motion;
    }
    return std::nullopt;
}

std::vector<std::string> motion_names() {
    std::vector<std::string> names;
    for (const auto& [name, motion] : kMotions) names.emplace_back(name);
    return names;
}

BodyPose posture(Motion motion, double phase_value) {
    const Phase phase{phase_value - std::floor(phase_value)};
    switch (motion) {
        case Motion::kWave:
            return wave(phase);
        case Motion::kPush:
            return push(phase);
        case Motion::kWalk:
            return walk(phase);
        case Motion::kStroll:
            return stroll(phase);
        case Motion::kSway:
            return sway(phase);
        case Motion::kRaise:
            return raise(phase);
        case Motion::kTableHands:
            return table_hands(phase);
        case Motion::kKick:
            return kick(phase);
        case Motion::kNudge:
            return nudge(phase);
        case Motion::kScoop:
            return scoop(phase);
        case Motion::kWade:
            return wade(phase);
        case Motion::kPart:
            return part(phase);
        case Motion::kCarry:
            return carry(phase);
    }
    assert(false);
    return {};
}

}  // namespace atrium::simulation
