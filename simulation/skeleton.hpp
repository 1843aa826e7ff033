#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>

namespace atrium::simulation {

// Body frame: origin on the floor between the feet, +X to the person's right, +Y forwards, +Z up,
// in metres of a person of kNominalHeight. Left limbs use the mirrored frame (x negated): +X is
// outwards on both sides.

constexpr double kNominalHeight = 1.75;

enum Bone : std::size_t {
    kPelvis,
    kChest,
    kHead,
    kUpperArm,  // right side; the left one is `left_of`
    kForearm,
    kHand,
    kThigh,
    kShin,
    kFoot,
    kFirstLeft,
    kNumBones = kFirstLeft + 6
};

constexpr Bone left_of(Bone right) { return static_cast<Bone>(right - kUpperArm + kFirstLeft); }

/// Joints of the rest pose, right side: arms hang outwards at an angle, legs are slightly apart.
struct RestJoints {
    Eigen::Vector3d waist{0.0, 0.0, 1.08};
    Eigen::Vector3d neck{0.0, -0.005, 1.49};
    Eigen::Vector3d shoulder{0.175, -0.005, 1.405};
    Eigen::Vector3d arm_direction{0.6428, 0.0, -0.7660};  // 50 degrees below the horizontal
    Eigen::Vector3d palm_direction{-0.7660, 0.0, -0.6428};
    double upper_arm_m = 0.275;
    double forearm_m = 0.245;
    double hand_m = 0.18;
    Eigen::Vector3d hip{0.095, 0.0, 0.93};
    Eigen::Vector3d knee{0.125, 0.01, 0.50};
    Eigen::Vector3d ankle{0.15, -0.01, 0.085};

    Eigen::Vector3d elbow() const { return shoulder + upper_arm_m * arm_direction; }
    Eigen::Vector3d wrist() const { return elbow() + forearm_m * arm_direction; }
};

/// Target of a hand. Out of reach, the arm points towards it.
struct ArmPose {
    Eigen::Vector3d wrist{0.27, 0.02, 0.90};
    Eigen::Vector3d elbow_towards{0.3, -1.0, 0.0};  // direction in which the elbow sticks out
    Eigen::Vector3d fingers{0.05, 0.15, -1.0};      // direction of the fingers
    Eigen::Vector3d palm{-1.0, 0.0, 0.0};           // direction that the palm faces
};

struct LegPose {
    Eigen::Vector3d ankle{0.11, -0.01, 0.085};
    double toe_down_rad = 0.0;
};

/// A posture in the body frame; `left` members are in the mirrored frame. Rotations are vectors:
/// axis times angle [rad].
struct BodyPose {
    Eigen::Vector3d shift = {0.0, 0.0, -0.012};  // of the trunk; slightly lower than straight knees
    Eigen::Vector3d pelvis_turn = Eigen::Vector3d::Zero();
    Eigen::Vector3d chest_turn = Eigen::Vector3d::Zero();  // relative to the pelvis
    Eigen::Vector3d head_turn = Eigen::Vector3d::Zero();   // relative to the chest
    ArmPose right_arm, left_arm;
    LegPose right_leg, left_leg;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // of all of this, on the floor
    double facing_rad = 0.0;                          // turns all of it left about its origin
};

/// `posed_from_rest` of each bone, with place and facing.
using BoneTransforms = std::array<geometry::RigidTransform, kNumBones>;

BoneTransforms pose_bones(const BodyPose& pose);

}  // namespace atrium::simulation
