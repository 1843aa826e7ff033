#include "simulation/skeleton.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::simulation {
namespace {

using geometry::RigidTransform;

Eigen::Vector3d mirrored(const Eigen::Vector3d& p) { return {-p.x(), p.y(), p.z()}; }

// Mirrors a motion; a rotation stays a rotation.
RigidTransform mirrored(const RigidTransform& t) {
    const Eigen::Quaterniond& q = t.rotation;
    return {Eigen::Quaterniond(q.w(), q.x(), -q.y(), -q.z()), mirrored(t.translation)};
}

Eigen::Quaterniond rotation(const Eigen::Vector3d& axis_angle) {
    const double angle = axis_angle.norm();
    if (angle < 1e-12) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis_angle / angle));
}

RigidTransform about(const Eigen::Vector3d& fixed_point, const Eigen::Quaterniond& turn) {
    return {turn, fixed_point - turn * fixed_point};
}

// Columns: `along`, the part of `side` perpendicular to it, and their cross product.
Eigen::Matrix3d frame(const Eigen::Vector3d& along, const Eigen::Vector3d& side) {
    Eigen::Matrix3d m;
    m.col(0) = along.normalized();
    m.col(1) = (side - side.dot(m.col(0)) * m.col(0)).normalized();
    m.col(2) = m.col(0).cross(m.col(1));
    return m;
}

// Moves `rest_joint` to `posed_joint` and rotates the rest frame into the posed one.
RigidTransform bone(const Eigen::Vector3d& rest_joint,
                    const Eigen::Matrix3d& rest_frame,
                    const Eigen::Vector3d& posed_joint,
                    const Eigen::Matrix3d& posed_frame) {
    const Eigen::Quaterniond turn(Eigen::Matrix3d(posed_frame * rest_frame.transpose()));
    return {turn, posed_joint - turn * rest_joint};
}

struct Bend {
    Eigen::Vector3d middle;
    Eigen::Vector3d end;
    Eigen::Vector3d side;  // perpendicular to start-end, towards the middle joint
};

// Solves two links from `start` towards `target`, with the middle joint on the side of `towards`.
Bend bend_two_links(const Eigen::Vector3d& start,
                    const Eigen::Vector3d& target,
                    const Eigen::Vector3d& towards,
                    double first_m,
                    double second_m) {
    const Eigen::Vector3d along = (target - start).normalized();
    // never fully straight nor folded: keeps the plane of the joint defined
    const double reach = std::clamp(
        (target - start).norm(), std::abs(first_m - second_m) + 0.03, 0.998 * (first_m + second_m));
    const double middle_along =
        (first_m * first_m - second_m * second_m + reach * reach) / (2.0 * reach);
    const double middle_off =
        std::sqrt(std::max(0.0, first_m * first_m - middle_along * middle_along));
    Bend bend;
    bend.side = (towards - towards.dot(along) * along).normalized();
    bend.middle = start + middle_along * along + middle_off * bend.side;
    bend.end = start + reach * along;
    return bend;
}

struct ArmBones {
    RigidTransform upper, fore, hand;
};

ArmBones pose_arm(const RestJoints& rest, const Eigen::Vector3d& shoulder, const ArmPose& arm) {
    const Bend bend =
        bend_two_links(shoulder, arm.wrist, arm.elbow_towards, rest.upper_arm_m, rest.forearm_m);
    const Eigen::Matrix3d rest_arm = frame(rest.arm_direction, -Eigen::Vector3d::UnitY());
    const Eigen::Matrix3d rest_hand = frame(rest.arm_direction, rest.palm_direction);
    const Eigen::Matrix3d posed_hand = frame(arm.fingers, arm.palm);
    ArmBones bones;
    bones.upper = bone(rest.shoulder, rest_arm, shoulder, frame(bend.middle - shoulder, bend.side));
    bones.hand = bone(rest.wrist(), rest_hand, bend.end, posed_hand);
    // the forearm twists half as far as the hand, as its two bones do
    const Eigen::Vector3d along = bend.end - bend.middle;
    const Eigen::Vector3d by_elbow = frame(along, bend.side).col(1);
    const Eigen::Vector3d little_finger =
        posed_hand * (rest_hand.transpose() * -Eigen::Vector3d::UnitY());
    const Eigen::Vector3d off_axis =
        little_finger - little_finger.dot(along.normalized()) * along.normalized();
    bones.fore = bone(rest.elbow(), rest_arm, bend.middle, frame(along, by_elbow + 0.8 * off_axis));
    return bones;
}

struct LegBones {
    RigidTransform thigh, shin, foot;
};

LegBones pose_leg(const RestJoints& rest, const Eigen::Vector3d& hip, const LegPose& leg) {
    const double thigh_m = (rest.knee - rest.hip).norm();
    const double shin_m = (rest.ankle - rest.knee).norm();
    const Eigen::Vector3d forwards = Eigen::Vector3d::UnitY();
    const Bend bend =
        bend_two_links(hip, leg.ankle, forwards + 0.12 * Eigen::Vector3d::UnitX(), thigh_m, shin_m);
    LegBones bones;
    bones.thigh = bone(
        rest.hip, frame(rest.knee - rest.hip, forwards), hip, frame(bend.middle - hip, bend.side));
    bones.shin = bone(rest.knee,
                      frame(rest.ankle - rest.knee, forwards),
                      bend.middle,
                      frame(bend.end - bend.middle, bend.side));
    const Eigen::Quaterniond pitch = rotation({-leg.toe_down_rad, 0.0, 0.0});
    bones.foot = {pitch, bend.end - pitch * rest.ankle};
    return bones;
}

}  // namespace

BoneTransforms pose_bones(const BodyPose& pose) {
    const RestJoints rest;
    const Eigen::Vector3d pelvis_centre(0.0, 0.0, rest.hip.z());
    BoneTransforms bones;
    bones[kPelvis] = about(pelvis_centre, rotation(pose.pelvis_turn));
    bones[kPelvis].translation += pose.shift;
    bones[kChest] = bones[kPelvis] * about(rest.waist, rotation(pose.chest_turn));
    bones[kHead] = bones[kChest] * about(rest.neck, rotation(pose.head_turn));

    const auto set_side = [&](bool left) {
        const auto placed = [&](const RigidTransform& t) { return left ? mirrored(t) : t; };
        const auto bone_of = [&](Bone right) { return left ? left_of(right) : right; };
        const ArmBones arm = pose_arm(
            rest, placed(bones[kChest]) * rest.shoulder, left ? pose.left_arm : pose.right_arm);
        bones[bone_of(kUpperArm)] = placed(arm.upper);
        bones[bone_of(kForearm)] = placed(arm.fore);
        bones[bone_of(kHand)] = placed(arm.hand);
        const LegBones leg = pose_leg(
            rest, placed(bones[kPelvis]) * rest.hip, left ? pose.left_leg : pose.right_leg);
        bones[bone_of(kThigh)] = placed(leg.thigh);
        bones[bone_of(kShin)] = placed(leg.shin);
        bones[bone_of(kFoot)] = placed(leg.foot);
    };
    set_side(false);
    set_side(true);
    const RigidTransform placed_from_body{rotation({0.0, 0.0, pose.facing_rad}), pose.place};
    for (RigidTransform& each : bones) each = placed_from_body * each;
    return bones;
}

}  // namespace atrium::simulation
