#include "simulation/joint_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

namespace atrium::simulation {
namespace {

struct Entry {
    std::string_view name;
    HumanJoint joint;  // of a limb: the left one
};

constexpr std::array kMiddle{Entry{"hips", HumanJoint::kHips},
                             Entry{"hip", HumanJoint::kHips},
                             Entry{"pelvis", HumanJoint::kHips},
                             Entry{"spine", HumanJoint::kSpine},
                             Entry{"lowerback", HumanJoint::kSpine},
                             Entry{"abdomen", HumanJoint::kSpine},
                             Entry{"spine01", HumanJoint::kSpine},
                             Entry{"spine001", HumanJoint::kSpine1},
                             Entry{"spine1", HumanJoint::kSpine1},
                             Entry{"spine02", HumanJoint::kSpine1},
                             Entry{"chest", HumanJoint::kSpine1},
                             Entry{"spine002", HumanJoint::kSpine2},
                             Entry{"spine2", HumanJoint::kSpine2},
                             Entry{"spine03", HumanJoint::kSpine2},
                             Entry{"upperchest", HumanJoint::kSpine2},
                             Entry{"chest2", HumanJoint::kSpine2},
                             Entry{"neck", HumanJoint::kNeck},
                             Entry{"neck01", HumanJoint::kNeck},
                             Entry{"head", HumanJoint::kHead}};

constexpr std::array kLimbs{
    Entry{"clavicle", HumanJoint::kLeftClavicle}, Entry{"collar", HumanJoint::kLeftClavicle},
    Entry{"shoulder", HumanJoint::kLeftClavicle}, Entry{"upperarm", HumanJoint::kLeftUpperArm},
    Entry{"uparm", HumanJoint::kLeftUpperArm},    Entry{"arm", HumanJoint::kLeftUpperArm},
    Entry{"shldr", HumanJoint::kLeftUpperArm},    Entry{"forearm", HumanJoint::kLeftForearm},
    Entry{"lowerarm", HumanJoint::kLeftForearm},  Entry{"lowarm", HumanJoint::kLeftForearm},
    Entry{"elbow", HumanJoint::kLeftForearm},     Entry{"hand", HumanJoint::kLeftHand},
    Entry{"wrist", HumanJoint::kLeftHand},        Entry{"thigh", HumanJoint::kLeftThigh},
    Entry{"upleg", HumanJoint::kLeftThigh},       Entry{"upperleg", HumanJoint::kLeftThigh},
    Entry{"hip", HumanJoint::kLeftThigh},         Entry{"shin", HumanJoint::kLeftShin},
    Entry{"calf", HumanJoint::kLeftShin},         Entry{"leg", HumanJoint::kLeftShin},
    Entry{"lowerleg", HumanJoint::kLeftShin},     Entry{"lowleg", HumanJoint::kLeftShin},
    Entry{"knee", HumanJoint::kLeftShin},         Entry{"foot", HumanJoint::kLeftFoot},
    Entry{"ankle", HumanJoint::kLeftFoot},        Entry{"toe", HumanJoint::kLeftToe},
    Entry{"toe0", HumanJoint::kLeftToe},          Entry{"toes", HumanJoint::kLeftToe},
    Entry{"toebase", HumanJoint::kLeftToe},       Entry{"ball", HumanJoint::kLeftToe}};

template <std::size_t kSize>
std::optional<HumanJoint> find(const std::array<Entry, kSize>& entries, std::string_view name) {
    const auto* const found = std::find_if(
        entries.begin(), entries.end(), [&](const Entry& e) { return e.name == name; });
    if (found == entries.end()) return std::nullopt;
    return found->joint;
}

HumanJoint right_of(HumanJoint left) {
    constexpr int kApart =
        static_cast<int>(HumanJoint::kRightClavicle) - static_cast<int>(HumanJoint::kLeftClavicle);
    return static_cast<HumanJoint>(static_cast<int>(left) + kApart);
}

std::optional<HumanJoint> limb(std::string_view name) {
    for (const auto& [side, is_right] : {std::pair<std::string_view, bool>{"left", false},
                                         {"right", true},
                                         {"l", false},
                                         {"r", true}}) {
        if (name.size() <= side.size()) continue;
        std::optional<HumanJoint> left;
        if (name.starts_with(side)) left = find(kLimbs, name.substr(side.size()));
        if (!left && name.ends_with(side))
            left = find(kLimbs, name.substr(0, name.size() - side.size()));
        if (left) return is_right ? right_of(*left) : *left;
    }
    return std::nullopt;
}

// The plain name without the prefix of its tool.
std::string_view bare(std::string_view name) {
    for (const std::string_view tool :
         {"mixamorig", "bip", "def", "jbipc", "jbipl", "jbipr", "cc"}) {
        if (!name.starts_with(tool)) continue;
        std::string_view rest = name.substr(tool.size());
        if (tool == "jbipl" || tool == "jbipr") return name.substr(tool.size() - 1);
        while (!rest.empty() && std::isdigit(static_cast<unsigned char>(rest.front())) != 0)
            rest.remove_prefix(1);
        return rest.starts_with("base") ? rest.substr(4) : rest;
    }
    return name;
}

// In Biovision's files a shoulder is an upper arm, and a collar precedes it; in Mixamo's it is the
// clavicle before the arm.
void name_shoulders(std::span<const std::string> names,
                    std::vector<std::optional<HumanJoint>>& joints) {
    const auto has = [&](std::string_view text) {
        return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
            return plain_name(name).find(text) != std::string::npos;
        });
    };
    if (has("uparm") || has("upperarm") || has("leftarm") || has("shldr") || has("larm")) return;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!joints[i] || plain_name(names[i]).find("shoulder") == std::string::npos) continue;
        if (joints[i] == HumanJoint::kLeftClavicle) joints[i] = HumanJoint::kLeftUpperArm;
        if (joints[i] == HumanJoint::kRightClavicle) joints[i] = HumanJoint::kRightUpperArm;
    }
}

}  // namespace

std::string plain_name(std::string_view name) {
    const std::size_t colon = name.find_last_of(":|");
    if (colon != std::string_view::npos) name.remove_prefix(colon + 1);
    std::string plain;
    for (const char c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return plain;
}

std::optional<HumanJoint> joint_before(HumanJoint joint) {
    switch (joint) {
        case HumanJoint::kHips:
            return std::nullopt;
        case HumanJoint::kSpine:
        case HumanJoint::kLeftThigh:
        case HumanJoint::kRightThigh:
            return HumanJoint::kHips;
        case HumanJoint::kLeftClavicle:
        case HumanJoint::kRightClavicle:
            return HumanJoint::kSpine2;
        default:
            return static_cast<HumanJoint>(static_cast<int>(joint) - 1);
    }
}

std::vector<std::optional<HumanJoint>> human_joints(std::span<const std::string> names) {
    std::vector<std::optional<HumanJoint>> joints;
    for (const std::string& name : names) {
        const std::string plain = plain_name(name);
        const std::string_view part = bare(plain);
        std::optional<HumanJoint> joint = find(kMiddle, part);
        joints.push_back(joint ? joint : limb(part));
    }
    name_shoulders(names, joints);
    std::set<HumanJoint> taken;
    for (std::optional<HumanJoint>& joint : joints) {
        if (joint && !taken.insert(*joint).second) joint.reset();
    }
    return joints;
}

}  // namespace atrium::simulation
