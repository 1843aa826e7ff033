#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Recognises the joints of a human skeleton by the names that common tools give them: Mixamo,
/// 3ds Max's biped (Rocketbox), CMU's and other BVH files, VRM, Unreal, Rigify.
namespace atrium::simulation {

enum class HumanJoint : std::uint8_t {
    kHips,
    kSpine,
    kSpine1,
    kSpine2,
    kNeck,
    kHead,
    kLeftClavicle,
    kLeftUpperArm,
    kLeftForearm,
    kLeftHand,
    kLeftThigh,
    kLeftShin,
    kLeftFoot,
    kLeftToe,
    kRightClavicle,
    kRightUpperArm,
    kRightForearm,
    kRightHand,
    kRightThigh,
    kRightShin,
    kRightFoot,
    kRightToe
};
constexpr std::size_t kNumHumanJoints = 22;

/// The joint before it, towards the hips; nullopt for the hips.
std::optional<HumanJoint> joint_before(HumanJoint joint);

/// Returns which name is which joint, index by index. At most one name per joint: the first.
std::vector<std::optional<HumanJoint>> human_joints(std::span<const std::string> names);

/// The name in lower case, without name space ("mixamorig:") and punctuation.
std::string plain_name(std::string_view name);

}  // namespace atrium::simulation
