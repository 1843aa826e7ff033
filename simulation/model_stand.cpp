#include "simulation/model_stand.hpp"

#include "core/geometry/aabb.hpp"
#include "core/geometry/alignment.hpp"
#include "simulation/joint_names.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace atrium::simulation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMinHeight_m = 0.5;
constexpr double kMaxHeight_m = 2.5;
constexpr double kUsualHeight_m = 1.75;
// Axes within this angle agree; cos 60 degrees.
constexpr double kAgrees = 0.5;

Matrix3d declared_upright(bool is_z_up) {
    Matrix3d turn;
    if (is_z_up) {
        turn << -1, 0, 0, 0, -1, 0, 0, 0, 1;
    } else {
        turn << -1, 0, 0, 0, 0, 1, 0, 1, 0;
    }
    return turn;
}

// Mean place of the nodes whose name contains one of the words.
std::optional<Vector3d> mean_of(const ModelRig& rig,
                                const std::vector<Eigen::Affine3f>& scene_from_node,
                                std::initializer_list<const char*> words) {
    Vector3d sum = Vector3d::Zero();
    int num = 0;
    for (std::size_t i = 0; i < rig.nodes.size(); ++i) {
        const std::string name = plain_name(rig.nodes[i].name);
        for (const char* word : words) {
            if (name.find(word) == std::string::npos) continue;
            sum += scene_from_node[i].translation().cast<double>();
            ++num;
            break;
        }
    }
    if (num == 0) return std::nullopt;
    return sum / num;
}

std::optional<Vector3d> direction(const std::optional<Vector3d>& from,
                                  const std::optional<Vector3d>& to) {
    if (!from || !to) return std::nullopt;
    const Vector3d along = *to - *from;
    const double length = along.norm();
    if (!(length > 1e-9) || !along.allFinite()) return std::nullopt;
    return along / length;
}

// The pose in which the skin was bound to the bones.
std::vector<Eigen::Affine3f> bound_nodes(const ModelRig& rig,
                                         const std::vector<Eigen::Affine3f>& rest) {
    std::vector<Eigen::Affine3f> bound = rest;
    for (const ModelBone& bone : rig.bones)
        bound[bone.node] = rest[bone.mesh_node] * bone.node_from_mesh.inverse();
    return bound;
}

// Rotates about Z in quarter turns until `right` is as near to +X as possible.
Matrix3d faced(const Matrix3d& upright, const std::optional<Vector3d>& right) {
    if (!right) return upright;
    const Vector3d now = upright * *right;
    const double angle = std::atan2(now.y(), now.x());
    const double quarters = std::round(angle / (0.5 * std::numbers::pi));
    return Eigen::AngleAxisd(-quarters * 0.5 * std::numbers::pi, Vector3d::UnitZ()) * upright;
}

double height_along(const Vector3d& up, const std::vector<Eigen::Vector3f>& positions) {
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const Eigen::Vector3f& p : positions) {
        const double z = up.dot(p.cast<double>());
        lowest = std::min(lowest, z);
        highest = std::max(highest, z);
    }
    return highest - lowest;
}

const char* axis_name(const Vector3d& axis) {
    int largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    constexpr std::array kNames{"+X", "+Y", "+Z", "-X", "-Y", "-Z"};
    return kNames[static_cast<std::size_t>(largest + (axis[largest] < 0.0 ? 3 : 0))];
}

}  // namespace

BodyAxes body_axes(const ModelRig& rig, const std::vector<Eigen::Affine3f>& scene_from_node) {
    BodyAxes axes;
    std::vector<std::string> names;
    for (const ModelNode& node : rig.nodes) names.push_back(node.name);
    const auto joints = human_joints(names);
    const auto at = [&](HumanJoint joint) -> std::optional<Vector3d> {
        for (std::size_t i = 0; i < joints.size(); ++i) {
            if (joints[i] == joint) return scene_from_node[i].translation().cast<double>();
        }
        return std::nullopt;
    };
    std::optional<Vector3d> top = at(HumanJoint::kHead);
    if (!top) top = mean_of(rig, scene_from_node, {"head"});
    if (!top) top = mean_of(rig, scene_from_node, {"neck"});
    std::optional<Vector3d> bottom = mean_of(rig, scene_from_node, {"foot", "ankle"});
    if (!bottom) bottom = mean_of(rig, scene_from_node, {"leg", "thigh", "knee"});
    axes.up = direction(bottom, top);
    axes.right = direction(at(HumanJoint::kLeftThigh), at(HumanJoint::kRightThigh));
    if (!axes.right)
        axes.right = direction(at(HumanJoint::kLeftUpperArm), at(HumanJoint::kRightUpperArm));
    return axes;
}

Matrix3d upright_of(const ModelRig& rig, const BodyAxes& axes) {
    const Matrix3d declared = declared_upright(rig.is_z_up);
    if (!axes.up) return declared;
    const Vector3d up = declared * *axes.up;
    if (up.z() >= kAgrees) return faced(declared, axes.right);
    // the nearest axis of the file becomes up
    Vector3d nearest = Vector3d::Zero();
    int largest = 0;
    up.cwiseAbs().maxCoeff(&largest);
    nearest[largest] = up[largest] < 0.0 ? -1.0 : 1.0;
    const Matrix3d turn = geometry::rotation_between(nearest, Vector3d::UnitZ()).toRotationMatrix();
    return faced(turn * declared, axes.right);
}

Standing find_standing(const ModelRig& rig) {
    std::vector<Eigen::Affine3f> rest;
    rest_nodes(rig, rest);
    PosedSkin skin;
    const auto height_of = [&](std::vector<Eigen::Affine3f> scene_from_node, const Vector3d& up) {
        pose_skin(rig, scene_from_node, skin);
        return height_along(up, skin.positions);
    };
    const Matrix3d declared = declared_upright(rig.is_z_up);
    const std::vector<Eigen::Affine3f> bound = bound_nodes(rig, rest);
    const auto agrees = [&](const BodyAxes& axes) {
        return axes.up && (declared * *axes.up).z() >= kAgrees;
    };
    const BodyAxes resting = body_axes(rig, rest);
    const BodyAxes binding = body_axes(rig, bound);
    const bool is_bound_pose = !agrees(resting) && agrees(binding);
    const BodyAxes& axes = is_bound_pose ? binding : resting;
    Standing standing{.upright = upright_of(rig, axes), .height = 0.0, .warnings = {}};
    const Vector3d up = standing.upright.row(2).transpose();
    if (!axes.up) {
        std::vector<Eigen::Affine3f> start;
        pose_nodes(rig, 0.0, start);
        standing.height = height_of(start, up);
        return standing;
    }
    standing.height = height_of(is_bound_pose ? bound : rest, up);
    if (!agrees(axes)) {
        standing.warnings.push_back(
            fmt::format("up is {} by the skeleton (feet to head), but {} by the file; the model is "
                        "turned upright",
                        axis_name(up),
                        axis_name(declared.row(2).transpose())));
    }
    return standing;
}

double metres_per_unit(const ModelRig& rig, double height, std::vector<std::string>& warnings) {
    const auto is_a_persons = [&](double scale) {
        return scale * height >= kMinHeight_m && scale * height <= kMaxHeight_m;
    };
    const double declared = rig.metres_per_unit > 0.0 ? rig.metres_per_unit : 1.0;
    if (is_a_persons(declared)) return declared;
    struct Unit {
        double in_m;
        const char* name;
    };
    for (const Unit& unit :
         {Unit{1.0, "metres"}, {0.01, "centimetres"}, {0.001, "millimetres"}, {0.0254, "inches"}}) {
        if (!is_a_persons(unit.in_m)) continue;
        warnings.push_back(fmt::format(
            "the model is {:.4g} m tall by the unit of its file; taken as {}: {:.2f} m. Set "
            "simulation.model_height_m if that is wrong",
            declared * height,
            unit.name,
            unit.in_m * height));
        return unit.in_m;
    }
    warnings.push_back(fmt::format(
        "the model is {:.4g} m tall by the unit of its file, which no person is; drawn {} m tall. "
        "Set simulation.model_height_m",
        declared * height,
        kUsualHeight_m));
    return kUsualHeight_m / height;
}

}  // namespace atrium::simulation
