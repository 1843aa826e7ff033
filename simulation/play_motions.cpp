#include "simulation/play_motions.hpp"

namespace atrium::simulation {
namespace {

using Eigen::Vector3d;

// Moves trunk and hands, but not the feet.
void advance(BodyPose& pose, double forwards_m) {
    const Vector3d way(0.0, forwards_m, 0.0);
    pose.shift += way;
    pose.right_arm.wrist += way;
    pose.left_arm.wrist += way;
}

// Steps between two phases from one place ahead of the body frame to another.
void step(LegPose& leg,
          const Phase& phase,
          double from,
          double to,
          double from_m,
          double to_m,
          double height_m) {
    const double t = phase.rise(from, to);
    leg.ankle.y() += from_m + t * (to_m - from_m);
    const double lift = 4.0 * t * (1.0 - t);
    leg.ankle.z() += height_m * lift;
    leg.toe_down_rad += 0.3 * lift;
}

}  // namespace

BodyPose kick(const Phase& phase) {
    BodyPose pose = stand(phase, 0.01);
    constexpr double kHipM = 0.918;  // above the floor, as is the leg's length to the ankle
    constexpr double kLegM = 0.833;
    const double lifted = phase.rise(0.06, 0.18) - phase.rise(0.84, 0.97);
    const double back = phase.rise(0.10, 0.34) - phase.rise(0.34, 0.56);
    const double ahead = phase.rise(0.34, 0.56) - phase.rise(0.62, 0.90);
    const double angle = 0.85 * ahead - 0.75 * back;
    // the knee is bent behind the body and nearly straight ahead of it
    const double length = kLegM - 0.035 * lifted - 0.12 * back;
    pose.right_leg.ankle = {
        0.11, -0.01 + length * std::sin(angle), kHipM - length * std::cos(angle)};
    pose.right_leg.toe_down_rad = 0.5 * back - 0.35 * ahead;
    // the trunk is over the other foot and leans against the leg
    pose.shift += Vector3d(-0.06 * lifted, -0.04 * ahead, 0.0);
    pose.pelvis_turn += Vector3d(0.10 * ahead - 0.08 * back, 0.0, 0.25 * ahead - 0.2 * back);
    pose.chest_turn += Vector3d(-0.10 * lifted, 0.0, 0.4 * back - 0.5 * ahead);
    pose.head_turn += Vector3d(-0.25 * lifted, 0.0, 0.25 * ahead - 0.2 * back);
    pose.right_arm.wrist += Vector3d(0.12 * lifted, 0.30 * back - 0.25 * ahead, 0.10 * lifted);
    pose.left_arm.wrist += Vector3d(0.16 * lifted, 0.32 * ahead - 0.2 * back, 0.16 * lifted);
    return pose;
}

BodyPose nudge(const Phase& phase) {
    BodyPose pose = stand(phase, 0.01);
    const double thrust = phase.rise(0.25, 0.48) - phase.rise(0.58, 0.95);
    const ArmPose drawn{.wrist = {0.22, 0.20, 1.13},
                        .elbow_towards = {0.7, -1.0, -0.6},
                        .fingers = {-0.1, 1.0, 0.0},
                        .palm = {-1.0, -0.1, 0.0}};
    const ArmPose thrown{.wrist = {0.12, 0.55, 1.15},
                         .elbow_towards = {0.8, 0.0, -0.8},
                         .fingers = {0.0, 1.0, 0.0},
                         .palm = {-1.0, 0.0, 0.0}};
    pose.right_arm = between(drawn, thrown, thrust);
    pose.shift += Vector3d(0.0, 0.05 * thrust, -0.01 * thrust);
    pose.chest_turn += Vector3d(-0.15 - 0.12 * thrust, 0.0, 0.25 * thrust);
    pose.head_turn += Vector3d(-0.15, 0.0, -0.2 * thrust);
    pose.left_arm.wrist += Vector3d(0.0, 0.05 - 0.10 * thrust, 0.02);
    return pose;
}

BodyPose scoop(const Phase& phase) {
    BodyPose pose = stand(phase, 0.01);
    const double down = phase.rise(0.02, 0.30) - phase.rise(0.44, 0.66);
    const double up = phase.rise(0.44, 0.66) - phase.rise(0.74, 0.98);
    const ArmPose ready{.wrist = {0.24, 0.28, 1.02},
                        .elbow_towards = {0.5, -1.0, -0.4},
                        .fingers = {-0.1, 1.0, -0.2},
                        .palm = {-0.3, 0.2, 1.0}};
    const ArmPose low{.wrist = {0.09, 0.44, 0.13},
                      .elbow_towards = {1.0, -0.4, 0.3},
                      .fingers = {-0.1, 1.0, -0.25},
                      .palm = {-0.3, 0.25, 1.0}};
    const ArmPose high{.wrist = {0.16, 0.46, 1.40},
                       .elbow_towards = {0.8, -0.2, -0.8},
                       .fingers = {0.0, 0.6, 0.8},
                       .palm = {-0.2, -0.8, 0.6}};
    pose.right_arm = between(between(ready, low, down), high, up);
    pose.left_arm = pose.right_arm;
    // the knees bend, the hips move back
    pose.shift += Vector3d(0.0, -0.14, -0.46) * down + Vector3d(0.0, 0.02, 0.0) * up;
    pose.pelvis_turn += Vector3d(-0.75 * down, 0.0, 0.0);
    pose.chest_turn += Vector3d(-0.35 * down + 0.10 * up, 0.0, 0.0);
    pose.head_turn += Vector3d(0.55 * down + 0.15 * up, 0.0, 0.0);
    for (LegPose* leg : {&pose.right_leg, &pose.left_leg}) leg->ankle.x() += 0.05;
    return pose;
}

BodyPose wade(const Phase& phase) {
    BodyPose pose;
    constexpr double kStepM = 0.25;  // height of the feet
    const auto tread = [&](LegPose& leg, double first) {
        // two steps forwards, one back over the whole distance
        constexpr double kSixth = 1.0 / 6.0;
        const double half = first + 2.0 * kSixth;
        const double last = first + 4.0 * kSixth;
        step(leg, phase, first, first + kSixth, 0.0, 0.15, kStepM);
        step(leg, phase, half, half + kSixth, 0.0, 0.15, kStepM);
        step(leg, phase, last, last + kSixth, 0.0, -0.30, kStepM);
    };
    tread(pose.right_leg, 0.0);
    tread(pose.left_leg, 1.0 / 6.0);
    const double swing = phase.sine(3);
    const auto arm = [](ArmPose& a, double forwards) {
        a.wrist = {0.36, 0.14 + 0.22 * forwards, 1.02 + 0.06 * forwards};
        a.elbow_towards = {0.6, -1.0, -0.2};
        a.fingers = {0.3, 0.9, -0.2 + 0.3 * forwards};
        a.palm = {-0.3, 0.1, -1.0};
    };
    arm(pose.right_arm, -swing);
    arm(pose.left_arm, swing);
    // the trunk is between the feet, over the supporting one
    advance(pose, 0.5 * (pose.right_leg.ankle.y() + pose.left_leg.ankle.y()) + 0.01);
    pose.shift += Vector3d(-0.035 * swing, 0.0, -0.03);
    pose.pelvis_turn = {0.0, 0.05 * swing, 0.12 * swing};
    pose.chest_turn = {-0.12, -0.07 * swing, -0.2 * swing};
    pose.head_turn = {-0.12, 0.0, 0.1 * swing};
    return pose;
}

BodyPose part(const Phase& phase) {
    BodyPose pose = stand(phase, 0.01);
    constexpr double kWayM = 0.5;
    const double reached = phase.rise(0.0, 0.20) - phase.rise(0.74, 1.0);
    const double open = phase.rise(0.22, 0.44) - phase.rise(0.68, 0.84);
    const ArmPose together{.wrist = {0.05, 0.46, 1.28},
                           .elbow_towards = {0.6, -0.2, -1.0},
                           .fingers = {0.0, 0.55, 1.0},
                           .palm = {1.0, 0.0, 0.0}};
    const ArmPose apart{.wrist = {0.46, 0.34, 1.28},
                        .elbow_towards = {0.3, -0.4, -1.0},
                        .fingers = {0.25, 0.35, 1.0},
                        .palm = {1.0, -0.1, -0.2}};
    pose.right_arm = between(between(pose.right_arm, together, reached), apart, open);
    pose.left_arm = between(between(pose.left_arm, together, reached), apart, open);
    advance(pose, kWayM * (phase.rise(0.26, 0.52) - phase.rise(0.62, 0.90)));
    step(pose.right_leg, phase, 0.26, 0.40, 0.0, kWayM, 0.08);
    step(pose.right_leg, phase, 0.76, 0.90, 0.0, -kWayM, 0.08);
    step(pose.left_leg, phase, 0.40, 0.54, 0.0, kWayM, 0.08);
    step(pose.left_leg, phase, 0.62, 0.76, 0.0, -kWayM, 0.08);
    pose.shift.z() -= 0.03;
    return pose;
}

BodyPose carry(const Phase& phase) {
    BodyPose pose = stand(phase, 0.01);
    const double lift = phase.rise(0.08, 0.30) - phase.rise(0.72, 0.94);
    const double side = phase.rise(0.32, 0.46) - phase.rise(0.56, 0.70);  // to the left and back
    const ArmPose arm{.wrist = {0.11, 0.38, 0.92 + 0.28 * lift},
                      .elbow_towards = {0.6, -0.5, -1.0},
                      .fingers = {0.0, 1.0, 0.05},
                      .palm = {0.0, -0.05, 1.0}};
    pose.right_arm = arm;
    pose.left_arm = arm;
    const double lean = 0.28 - 0.22 * lift;
    pose.shift += Vector3d(-0.10 * side, -0.04, -0.02);
    pose.right_arm.wrist.x() -= 0.10 * side;
    pose.left_arm.wrist.x() += 0.10 * side;
    pose.pelvis_turn += Vector3d(-0.3 * lean, 0.0, 0.0);
    pose.chest_turn += Vector3d(-0.7 * lean, 0.0, 0.0);
    pose.head_turn += Vector3d(-0.2, 0.0, 0.15 * side);
    return pose;
}

}  // namespace atrium::simulation
