#include "simulation/model_nodes.hpp"

#include "core/base/readable.hpp"
#include "core/model/assimp_errors.hpp"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

namespace atrium::simulation {
namespace {

constexpr int kMaxDepth = 1000;

bool add_nodes(const aiNode& node, int parent, int depth, ModelRig& rig) {
    if (depth > kMaxDepth) return false;
    const auto index = static_cast<int>(rig.nodes.size());
    ModelNode ours;
    ours.name = node.mName.C_Str();
    ours.parent = parent;
    ours.parent_from_node = to_eigen(node.mTransformation);
    rig.nodes.push_back(std::move(ours));
    for (unsigned i = 0; i < node.mNumChildren; ++i) {
        if (!add_nodes(*node.mChildren[i], index, depth + 1, rig)) return false;
    }
    return true;
}

// FBX states its unit in centimetres; glTF is in metres; Assimp converts Collada's.
double metres_per_unit(const aiScene& scene, const std::filesystem::path& file) {
    double in_cm = 0.0;
    float in_cm_single = 0.0f;
    if (scene.mMetaData != nullptr) {
        if (scene.mMetaData->Get("UnitScaleFactor", in_cm)) return 0.01 * in_cm;
        if (scene.mMetaData->Get("UnitScaleFactor", in_cm_single))
            return 0.01 * static_cast<double>(in_cm_single);
    }
    const std::string suffix = file.extension().string();
    const bool is_metric = suffix == ".gltf" || suffix == ".glb" || suffix == ".dae";
    return is_metric ? 1.0 : 0.0;
}

bool moves(const aiNodeAnim& channel) {
    const auto differs = [](const auto* keys, unsigned num_keys) {
        return std::any_of(keys, keys + num_keys, [&](const auto& key) {
            return !(key.mValue == keys[0].mValue);
        });
    };
    return differs(channel.mPositionKeys, channel.mNumPositionKeys) ||
           differs(channel.mRotationKeys, channel.mNumRotationKeys) ||
           differs(channel.mScalingKeys, channel.mNumScalingKeys);
}

// Mixamo's files begin with an empty take.
const aiAnimation* first_that_moves(const aiScene& scene) {
    for (unsigned a = 0; a < scene.mNumAnimations; ++a) {
        const aiAnimation& animation = *scene.mAnimations[a];
        const bool is_moving =
            std::any_of(animation.mChannels,
                        animation.mChannels + animation.mNumChannels,
                        [](const aiNodeAnim* channel) { return moves(*channel); });
        if (is_moving) return &animation;
    }
    return scene.mNumAnimations > 0 ? scene.mAnimations[0] : nullptr;
}

// First and last time of all keys [ticks].
std::pair<double, double> span_of(const aiAnimation& animation) {
    double first = std::numeric_limits<double>::infinity();
    double last = 0.0;
    for (unsigned c = 0; c < animation.mNumChannels; ++c) {
        const aiNodeAnim& channel = *animation.mChannels[c];
        const auto add = [&](const auto* keys, unsigned num_keys) {
            if (num_keys < 2) return;  // a single key is a constant
            first = std::min(first, keys[0].mTime);
            last = std::max(last, keys[num_keys - 1].mTime);
        };
        add(channel.mPositionKeys, channel.mNumPositionKeys);
        add(channel.mRotationKeys, channel.mNumRotationKeys);
        add(channel.mScalingKeys, channel.mNumScalingKeys);
    }
    return first < last ? std::pair(first, last) : std::pair(0.0, 0.0);
}

Eigen::Vector3f value_of(const aiVector3D& v) { return to_eigen(v); }
Eigen::Quaternionf value_of(const aiQuaternion& q) {
    return Eigen::Quaternionf(q.w, q.x, q.y, q.z).normalized();
}

}  // namespace

Expected<const aiScene*> read_scene(const char* option,
                                    const std::filesystem::path& file,
                                    Assimp::Importer& importer) {
    if (const auto readable = check_readable(file); !readable) {
        return make_error(readable.error().kind,
                          fmt::format("{}: {}", option, readable.error().message));
    }
    // with pivots, bones would hang below animated helper nodes that Assimp mixes up
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    const aiScene* scene = importer.ReadFile(file.string(), 0);
    // a motion has no mesh, which the validation would refuse
    if (scene != nullptr && scene->mNumMeshes > 0) {
        scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_GenSmoothNormals |
                                             aiProcess_SortByPType | aiProcess_FlipUVs |
                                             aiProcess_ValidateDataStructure);
    }
    if (scene == nullptr) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format(
                "{}: {}: {}", option, file.string(), model::why_unreadable(file, importer)));
    }
    return scene;
}

Expected<void> take_nodes(const aiScene& scene, const std::filesystem::path& file, ModelRig& rig) {
    const auto invalid = [&](const char* what) {
        return make_error(ErrorKind::kInvalidData, fmt::format("{}: {}", file.string(), what));
    };
    if (scene.mRootNode == nullptr) return invalid("has no nodes");
    if (!add_nodes(*scene.mRootNode, -1, 0, rig)) return invalid("its nodes are nested too deeply");
    int up_axis = 1;
    if (scene.mMetaData != nullptr && scene.mMetaData->Get("UpAxis", up_axis))
        rig.is_z_up = up_axis == 2;
    rig.metres_per_unit = metres_per_unit(scene, file);
    return {};
}

void take_animation(const aiScene& scene, ModelRig& rig) {
    const aiAnimation* animation = first_that_moves(scene);
    if (animation == nullptr) return;
    // Assimp's documented default
    const double ticks_per_s = animation->mTicksPerSecond > 0.0 ? animation->mTicksPerSecond : 25.0;
    const auto [first, last] = span_of(*animation);
    rig.animation = animation->mName.C_Str();
    rig.duration_s = (last - first) / ticks_per_s;
    std::map<std::string, std::size_t> by_name;
    for (std::size_t i = 0; i < rig.nodes.size(); ++i) by_name.emplace(rig.nodes[i].name, i);
    for (unsigned c = 0; c < animation->mNumChannels; ++c) {
        const aiNodeAnim& channel = *animation->mChannels[c];
        const auto found = by_name.find(channel.mNodeName.C_Str());
        if (found == by_name.end()) continue;
        ModelNode& node = rig.nodes[found->second];
        const auto take = [&](const auto* keys, unsigned num_keys, auto& out) {
            for (unsigned k = 0; k < num_keys; ++k)
                out.push_back({(keys[k].mTime - first) / ticks_per_s, value_of(keys[k].mValue)});
        };
        take(channel.mPositionKeys, channel.mNumPositionKeys, node.translations);
        take(channel.mRotationKeys, channel.mNumRotationKeys, node.rotations);
        take(channel.mScalingKeys, channel.mNumScalingKeys, node.scales);
    }
}

Expected<ModelRig> read_motion(const std::filesystem::path& file) {
    Assimp::Importer importer;
    const auto scene = read_scene("simulation.motion_file", file, importer);
    if (!scene) return tl::unexpected(scene.error());
    ModelRig rig;
    if (auto taken = take_nodes(**scene, file, rig); !taken) return tl::unexpected(taken.error());
    take_animation(**scene, rig);
    if (rig.duration_s <= 0.0) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("simulation.motion_file: '{}': has no animation that moves "
                                      "something. Export the motion with its keys baked",
                                      file.string()));
    }
    return rig;
}

}  // namespace atrium::simulation
