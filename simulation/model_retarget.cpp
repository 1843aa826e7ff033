#include "core/geometry/alignment.hpp"
#include "simulation/joint_names.hpp"
#include "simulation/model_rig.hpp"
#include "simulation/model_stand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

// Carries a motion from one skeleton to another. The directions of bones are copied: the target is
// first posed like the resting source, then follows its rotations in the upright frame. Skeletons
// of the same tool (same names, same local offsets) copy local rotations instead, fingers included.
namespace atrium::simulation {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;

constexpr double kMostSamplesPerS = 60.0;
constexpr double kMostSamples = 20'000;

std::vector<std::string> names_of(const ModelRig& rig) {
    std::vector<std::string> names;
    for (const ModelNode& node : rig.nodes) names.push_back(node.name);
    return names;
}

Quaternionf rotation_of(const Eigen::Affine3f& transform) {
    Eigen::Matrix3f rotation;
    Eigen::Matrix3f scaling;
    transform.computeRotationScaling(&rotation, &scaling);
    return Quaternionf(rotation).normalized();
}

// Node of each joint, -1 where it has none.
std::array<int, kNumHumanJoints> joint_nodes(const ModelRig& rig) {
    std::array<int, kNumHumanJoints> nodes{};
    nodes.fill(-1);
    const auto joints = human_joints(names_of(rig));
    for (std::size_t i = 0; i < joints.size(); ++i) {
        if (joints[i]) nodes[static_cast<std::size_t>(*joints[i])] = static_cast<int>(i);
    }
    return nodes;
}

class Retargeting {
public:
    Retargeting(const ModelRig& source, ModelRig& target) : source_(source), target_(target) {
        rest_nodes(source, source_rest_);
        rest_nodes(target, target_rest_);
        source_upright_ =
            Quaternionf(upright_of(source, body_axes(source, source_rest_)).cast<float>());
        target_upright_ =
            Quaternionf(upright_of(target, body_axes(target, target_rest_)).cast<float>());
        match();
    }

    std::size_t num_matched() const { return pairs_.size(); }
    bool has_hips() const { return hips_.target >= 0; }

    void run() {
        const double num_wanted = std::ceil(source_.duration_s * kMostSamplesPerS);
        const auto num = static_cast<int>(std::clamp(num_wanted, 1.0, kMostSamples));
        for (ModelNode& node : target_.nodes) {
            node.translations.clear();
            node.rotations.clear();
            node.scales.clear();
        }
        target_.duration_s = source_.duration_s;
        target_.animation = source_.animation;
        std::vector<Eigen::Affine3f> posed;
        for (int i = 0; i <= num; ++i) {
            const double time_s = source_.duration_s * i / num;
            pose_nodes(source_, time_s, posed);
            if (i == 0) source_start_ = posed[static_cast<std::size_t>(hips_.source)];
            add_keys(time_s, posed);
        }
    }

private:
    struct Pair {
        int source = -1;
        int target = -1;
        Quaternionf align = Quaternionf::Identity();  // of the target's rest pose, upright frame
        bool is_local = false;                        // copies the local rotation
    };

    void match();
    bool is_same_rig(const std::map<std::string, int>& by_name) const;
    void match_by_name(const std::map<std::string, int>& by_name);
    void match_joints();
    void align_rest_poses(const std::array<int, kNumHumanJoints>& from,
                          const std::array<int, kNumHumanJoints>& to);
    double size_ratio() const;
    void add_keys(double time_s, const std::vector<Eigen::Affine3f>& posed);

    const ModelRig& source_;
    ModelRig& target_;
    std::vector<Eigen::Affine3f> source_rest_, target_rest_;
    Quaternionf source_upright_, target_upright_;
    std::map<int, Pair> pairs_;  // by target
    Pair hips_;
    bool has_same_axes_ = false;
    float ratio_ = 1.0f;
    Eigen::Affine3f source_start_;
};

void Retargeting::match() {
    std::map<std::string, int> by_name;
    for (std::size_t i = 0; i < source_.nodes.size(); ++i)
        by_name.emplace(plain_name(source_.nodes[i].name), static_cast<int>(i));
    has_same_axes_ = is_same_rig(by_name);
    match_joints();
    if (has_same_axes_) match_by_name(by_name);
    ratio_ = static_cast<float>(size_ratio());
}

// The same tool made both if bones of the same name have their children in the same local
// directions.
bool Retargeting::is_same_rig(const std::map<std::string, int>& by_name) const {
    int num_same = 0;
    int num_other = 0;
    for (const ModelNode& node : target_.nodes) {
        const auto found = by_name.find(plain_name(node.name));
        if (found == by_name.end() || node.parent < 0) continue;
        const ModelNode& twin = source_.nodes[static_cast<std::size_t>(found->second)];
        if (twin.parent < 0) continue;
        const auto parent = static_cast<std::size_t>(node.parent);
        const auto twin_parent = static_cast<std::size_t>(twin.parent);
        if (plain_name(target_.nodes[parent].name) != plain_name(source_.nodes[twin_parent].name))
            continue;
        const Vector3f a = node.parent_from_node.translation();
        const Vector3f b = twin.parent_from_node.translation();
        if (a.norm() < 1e-6f || b.norm() < 1e-6f) continue;
        const bool is_same = a.normalized().dot(b.normalized()) > 0.94f;  // 20 degrees
        ++(is_same ? num_same : num_other);
    }
    return num_same >= 4 && num_same > 10 * num_other;
}

void Retargeting::match_by_name(const std::map<std::string, int>& by_name) {
    std::vector<bool> is_above_hips(target_.nodes.size(), false);
    for (int i = hips_.target; i >= 0; i = target_.nodes[static_cast<std::size_t>(i)].parent)
        is_above_hips[static_cast<std::size_t>(i)] = true;
    for (std::size_t i = 0; i < target_.nodes.size(); ++i) {
        const auto found = by_name.find(plain_name(target_.nodes[i].name));
        if (found == by_name.end() || is_above_hips[i]) continue;
        if (!source_.nodes[static_cast<std::size_t>(found->second)].is_animated()) continue;
        const auto index = static_cast<int>(i);
        pairs_[index] = {found->second, index, Quaternionf::Identity(), true};
    }
}

void Retargeting::match_joints() {
    const auto from = joint_nodes(source_);
    const auto to = joint_nodes(target_);
    for (std::size_t j = 0; j < kNumHumanJoints; ++j) {
        if (from[j] < 0 || to[j] < 0) continue;
        pairs_[to[j]] = {from[j], to[j], Quaternionf::Identity(), false};
    }
    align_rest_poses(from, to);
    const auto hips = static_cast<std::size_t>(HumanJoint::kHips);
    if (from[hips] >= 0 && to[hips] >= 0) hips_ = pairs_[to[hips]];
}

// Arms and legs: the rotation from the target's resting limb to the source's. A hand or foot
// without a known end follows its limb.
void Retargeting::align_rest_poses(const std::array<int, kNumHumanJoints>& from,
                                   const std::array<int, kNumHumanJoints>& to) {
    for (std::size_t j = static_cast<std::size_t>(HumanJoint::kLeftUpperArm); j < kNumHumanJoints;
         ++j) {
        if (from[j] < 0 || to[j] < 0) continue;
        const auto joint = static_cast<HumanJoint>(j);
        if (joint == HumanJoint::kRightClavicle) continue;
        const bool has_next = j + 1 < kNumHumanJoints &&
                              joint_before(static_cast<HumanJoint>(j + 1)) == joint &&
                              from[j + 1] >= 0 && to[j + 1] >= 0;
        Quaternionf& align = pairs_[to[j]].align;
        if (!has_next) {
            const auto before = joint_before(joint);
            const int limb = before ? to[static_cast<std::size_t>(*before)] : -1;
            if (limb >= 0 && joint != HumanJoint::kLeftToe && joint != HumanJoint::kRightToe)
                align = pairs_[limb].align;
            continue;
        }
        const auto along = [&](const std::vector<Eigen::Affine3f>& rest,
                               const std::array<int, kNumHumanJoints>& nodes,
                               const Quaternionf& upright) {
            return Vector3f(upright * (rest[static_cast<std::size_t>(nodes[j + 1])].translation() -
                                       rest[static_cast<std::size_t>(nodes[j])].translation()));
        };
        const Vector3f a = along(target_rest_, to, target_upright_);
        const Vector3f b = along(source_rest_, from, source_upright_);
        if (a.norm() > 1e-6f && b.norm() > 1e-6f)
            align = geometry::rotation_between(a.cast<double>(), b.cast<double>()).cast<float>();
    }
}

// Of the bones' lengths, in the units of both scenes.
double Retargeting::size_ratio() const {
    double ours = 0.0;
    double theirs = 0.0;
    for (const auto& [index, pair] : pairs_) {
        const int parent = target_.nodes[static_cast<std::size_t>(index)].parent;
        const auto up = pairs_.find(parent);
        if (up == pairs_.end()) continue;
        const auto length = [](const std::vector<Eigen::Affine3f>& rest, int a, int b) {
            return static_cast<double>((rest[static_cast<std::size_t>(a)].translation() -
                                        rest[static_cast<std::size_t>(b)].translation())
                                           .norm());
        };
        ours += length(target_rest_, index, parent);
        theirs += length(source_rest_, pair.source, up->second.source);
    }
    return theirs > 0.0 ? ours / theirs : 1.0;
}

void Retargeting::add_keys(double time_s, const std::vector<Eigen::Affine3f>& posed) {
    std::vector<Quaternionf> scene_rotation(target_.nodes.size());
    for (std::size_t i = 0; i < target_.nodes.size(); ++i) {
        ModelNode& node = target_.nodes[i];
        const Quaternionf parent = node.parent < 0
                                       ? Quaternionf::Identity()
                                       : scene_rotation[static_cast<std::size_t>(node.parent)];
        const auto found = pairs_.find(static_cast<int>(i));
        if (found == pairs_.end()) {
            scene_rotation[i] = parent * rotation_of(node.parent_from_node);
            continue;
        }
        const Pair& pair = found->second;
        const auto from = static_cast<std::size_t>(pair.source);
        Quaternionf local;
        if (pair.is_local) {
            const int up = source_.nodes[from].parent;
            const Quaternionf above =
                up < 0 ? Quaternionf::Identity() : rotation_of(posed[static_cast<std::size_t>(up)]);
            local = above.conjugate() * rotation_of(posed[from]);
        } else {
            const Quaternionf now = source_upright_ * rotation_of(posed[from]);
            const Quaternionf rest = source_upright_ * rotation_of(source_rest_[from]);
            const Quaternionf ours = target_upright_ * rotation_of(target_rest_[i]);
            const Quaternionf upright =
                has_same_axes_ ? now : Quaternionf(now * rest.conjugate() * pair.align * ours);
            local = parent.conjugate() * (target_upright_.conjugate() * upright);
        }
        local.normalize();
        scene_rotation[i] = parent * local;
        node.rotations.push_back({time_s, local});
    }
    // the hips also move
    const auto hips = static_cast<std::size_t>(hips_.target);
    const Vector3f moved =
        posed[static_cast<std::size_t>(hips_.source)].translation() - source_start_.translation();
    const Vector3f in_scene =
        target_rest_[hips].translation() +
        target_upright_.conjugate() * (source_upright_ * Vector3f(ratio_ * moved));
    ModelNode& node = target_.nodes[hips];
    const Eigen::Affine3f parent = node.parent < 0
                                       ? Eigen::Affine3f::Identity()
                                       : target_rest_[static_cast<std::size_t>(node.parent)];
    node.translations.push_back({time_s, parent.inverse() * in_scene});
}

std::string first_names(const ModelRig& rig) {
    constexpr std::size_t kMost = 12;
    std::vector<std::string> names;
    for (const ModelNode& node : rig.nodes) {
        if (names.size() < kMost && !node.name.empty()) names.push_back(node.name);
    }
    return fmt::format(
        "{}{}", fmt::join(names, ", "), rig.nodes.size() > names.size() ? ", ..." : "");
}

}  // namespace

Expected<void> apply_motion(const ModelRig& motion,
                            const std::filesystem::path& motion_file,
                            ModelRig& rig) {
    const auto invalid = [&](const std::string& what) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("simulation.motion_file: '{}': {}", motion_file.string(), what));
    };
    if (rig.num_skin_bones == 0) {
        return invalid(
            "the model's mesh has no bones with weights (no skin), so no motion can move it. "
            "Export "
            "the model with its skin");
    }
    constexpr std::size_t kFewest = 6;
    Retargeting retargeting(motion, rig);
    if (!retargeting.has_hips() || retargeting.num_matched() < kFewest) {
        return invalid(fmt::format(
            "its bones do not match the model's: {} of the model's bones are known by name, hips "
            "{}. The motion has: {}. The model has: {}. Known are the names of Mixamo, biped "
            "(Rocketbox), CMU and other BVH files, VRM, Unreal and Rigify: rename the bones",
            retargeting.num_matched(),
            retargeting.has_hips() ? "included" : "missing",
            first_names(motion),
            first_names(rig)));
    }
    retargeting.run();
    return {};
}

}  // namespace atrium::simulation
