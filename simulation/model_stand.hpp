#pragma once

#include "simulation/model_rig.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace atrium::simulation {

/// How a model stands.
struct Standing {
    Eigen::Matrix3d upright;  // rotates the file's axes to +Z up and +Y forwards
    double height = 0.0;      // of the standing model, in units of the file
    std::vector<std::string> warnings;
};

/// Finds up, forwards and height. The resting skeleton decides (from its feet to its head, from its
/// left to its right), not the extents: arms may span more than the body is tall, and an animation
/// may lie down. Without bones of a known name the file's axes count, and the height is that at the
/// start of the animation.
Standing find_standing(const ModelRig& rig);

/// Scale to metres for a model of `height` units: the file's unit if that gives the height of a
/// person, else another usual unit, else one that makes it 1.75 m tall; then adds a warning.
double metres_per_unit(const ModelRig& rig, double height, std::vector<std::string>& warnings);

/// From feet to head and from left to right, as unit vectors; empty where names are unknown.
struct BodyAxes {
    std::optional<Eigen::Vector3d> up;
    std::optional<Eigen::Vector3d> right;
};
BodyAxes body_axes(const ModelRig& rig, const std::vector<Eigen::Affine3f>& scene_from_node);

/// The rotation of the file's axes that its declaration and the body's axes give: up as declared
/// unless `axes` contradict it.
Eigen::Matrix3d upright_of(const ModelRig& rig, const BodyAxes& axes);

}  // namespace atrium::simulation
