#include "simulation/model_rig.hpp"

#include <algorithm>

namespace atrium::simulation {
namespace {

Eigen::Vector3f between(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float share) {
    return a + share * (b - a);
}

Eigen::Quaternionf between(const Eigen::Quaternionf& a, const Eigen::Quaternionf& b, float share) {
    return a.slerp(share, b).normalized();
}

// Keys are sorted by time; before the first and after the last the value is constant.
template <typename Value>
Value value_at(const std::vector<ModelKey<Value>>& keys, double time_s) {
    const auto next = std::upper_bound(
        keys.begin(), keys.end(), time_s, [](double t, const auto& key) { return t < key.time_s; });
    if (next == keys.begin()) return keys.front().value;
    if (next == keys.end()) return keys.back().value;
    const auto former = next - 1;
    const double span_s = next->time_s - former->time_s;
    const double share = span_s > 0.0 ? (time_s - former->time_s) / span_s : 0.0;
    return between(former->value, next->value, static_cast<float>(share));
}

Eigen::Affine3f parent_from_node(const ModelNode& node, double time_s) {
    if (!node.is_animated()) return node.parent_from_node;
    // without keys the rest value remains
    Eigen::Matrix3f rotation;
    Eigen::Matrix3f scaling;
    node.parent_from_node.computeRotationScaling(&rotation, &scaling);
    Eigen::Affine3f transform = Eigen::Affine3f::Identity();
    transform.translation() = node.translations.empty()
                                  ? Eigen::Vector3f(node.parent_from_node.translation())
                                  : value_at(node.translations, time_s);
    if (!node.rotations.empty()) rotation = value_at(node.rotations, time_s).toRotationMatrix();
    if (!node.scales.empty()) scaling = value_at(node.scales, time_s).asDiagonal();
    transform.linear() = rotation * scaling;
    return transform;
}

}  // namespace

void pose_nodes(const ModelRig& rig, double time_s, std::vector<Eigen::Affine3f>& out) {
    out.resize(rig.nodes.size());
    for (std::size_t i = 0; i < rig.nodes.size(); ++i) {
        const ModelNode& node = rig.nodes[i];
        const Eigen::Affine3f own = parent_from_node(node, time_s);
        out[i] = node.parent < 0 ? own : out[static_cast<std::size_t>(node.parent)] * own;
    }
}

void rest_nodes(const ModelRig& rig, std::vector<Eigen::Affine3f>& out) {
    out.resize(rig.nodes.size());
    for (std::size_t i = 0; i < rig.nodes.size(); ++i) {
        const ModelNode& node = rig.nodes[i];
        out[i] = node.parent < 0
                     ? node.parent_from_node
                     : out[static_cast<std::size_t>(node.parent)] * node.parent_from_node;
    }
}

void pose_rig(const ModelRig& rig,
              double time_s,
              std::vector<Eigen::Affine3f>& scratch,
              PosedSkin& out) {
    pose_nodes(rig, time_s, scratch);
    pose_skin(rig, scratch, out);
}

void pose_skin(const ModelRig& rig, std::vector<Eigen::Affine3f>& scratch, PosedSkin& out) {
    const std::size_t num_nodes = rig.nodes.size();
    scratch.resize(num_nodes + rig.bones.size());  // nodes, then scene_from_mesh of the bones
    for (std::size_t i = 0; i < rig.bones.size(); ++i)
        scratch[num_nodes + i] = scratch[rig.bones[i].node] * rig.bones[i].node_from_mesh;
    out.positions.resize(rig.positions.size());
    out.normals.resize(rig.positions.size());
    for (std::size_t v = 0; v < rig.positions.size(); ++v) {
        Eigen::Matrix<float, 3, 4> blend = Eigen::Matrix<float, 3, 4>::Zero();
        for (std::uint32_t k = rig.first_weight[v]; k < rig.first_weight[v + 1]; ++k) {
            blend += rig.weights[k].weight *
                     scratch[num_nodes + rig.weights[k].bone].matrix().topRows<3>();
        }
        out.positions[v] = blend.leftCols<3>() * rig.positions[v] + blend.col(3);
        const Eigen::Vector3f normal = blend.leftCols<3>() * rig.normals[v];
        const float length = normal.norm();
        out.normals[v] =
            length > 0.0f ? Eigen::Vector3f(normal / length) : Eigen::Vector3f::UnitY();
    }
}

}  // namespace atrium::simulation
