#pragma once

#include "simulation/model.hpp"

#include <Eigen/Geometry>

#include <string>
#include <vector>

struct aiAnimation;
struct aiScene;

namespace atrium::simulation {

/// Key of an animation: `value` at `time_s`.
template <typename Value>
struct ModelKey {
    double time_s = 0.0;
    Value value;
};

/// A node of the model's tree; parents come before their children.
struct ModelNode {
    std::string name;
    int parent = -1;                                                 // -1: the root
    Eigen::Affine3f parent_from_node = Eigen::Affine3f::Identity();  // without animation
    // empty: rest values
    std::vector<ModelKey<Eigen::Vector3f>> translations;
    std::vector<ModelKey<Eigen::Quaternionf>> rotations;
    std::vector<ModelKey<Eigen::Vector3f>> scales;
    bool is_animated() const {
        return !translations.empty() || !rotations.empty() || !scales.empty();
    }
};

/// Moves vertices by `scene_from_node * node_from_mesh`, with a weight.
struct ModelBone {
    std::size_t node = 0;
    Eigen::Affine3f node_from_mesh = Eigen::Affine3f::Identity();
    std::size_t mesh_node = 0;  // the node of its mesh
};

struct BoneWeight {
    std::uint32_t bone = 0;
    float weight = 0.0f;
};

/// Rest vertices, and the nodes and bones that move them.
struct ModelRig {
    std::vector<ModelNode> nodes;
    std::vector<ModelBone> bones;
    std::vector<Eigen::Vector3f> positions, normals;  // in the frame of their mesh
    std::vector<BoneWeight> weights;                  // of all vertices, one after the other
    std::vector<std::uint32_t> first_weight;          // per vertex, plus the end
    std::string animation;                            // its name
    double duration_s = 0.0;
    std::size_t num_skin_bones = 0;  // bones that the file's skins name
    bool is_z_up = false;            // as the file declares
    double metres_per_unit = 0.0;    // as the file declares; 0: it does not
};

/// Rig and surface of a model.
struct ModelParts {
    ModelRig rig;
    ModelSurface surface;
    std::vector<std::string> warnings;
};

/// Converts the scene that Assimp read from `file`, with its first animation that moves something;
/// pictures are searched beside `file`. Error kInvalidData.
Expected<ModelParts> take_model(const aiScene& scene, const std::filesystem::path& file);

/// Reads only the nodes and the animation of `file`, such as a BVH motion. Errors kNotFound,
/// kInvalidData.
Expected<ModelRig> read_motion(const std::filesystem::path& file);

/// Makes `rig` move as `motion`, whose bones may have other names and another rest pose
/// (joint_names.hpp). Error kInvalidData lists the names if they do not match; its text begins with
/// `motion_file`.
Expected<void> apply_motion(const ModelRig& motion,
                            const std::filesystem::path& motion_file,
                            ModelRig& rig);

/// Computes `scene_from_node` of every node at `time_s` of the animation, 0 to its duration.
void pose_nodes(const ModelRig& rig, double time_s, std::vector<Eigen::Affine3f>& out);
/// Computes `scene_from_node` of every node without animation.
void rest_nodes(const ModelRig& rig, std::vector<Eigen::Affine3f>& out);

/// Computes positions and unit normals for these poses of the nodes, in the file's frame. Appends
/// to `scene_from_node` as scratch.
void pose_skin(const ModelRig& rig, std::vector<Eigen::Affine3f>& scene_from_node, PosedSkin& out);

/// Computes positions and unit normals at `time_s`, in the file's frame. `scratch` is for
/// `pose_nodes`.
void pose_rig(const ModelRig& rig,
              double time_s,
              std::vector<Eigen::Affine3f>& scratch,
              PosedSkin& out);

}  // namespace atrium::simulation
