#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::physics {

enum class SoftShape : std::uint8_t { kCloth, kRope, kBall, kBox, kModel };

/// Selects the nodes of a pin. Cloth: edges and corners, top is +z, right is +x. Rope: left is the
/// start, right the end. kPoint: the nearest node, for any shape.
enum class PinPlace : std::uint8_t { kTop, kBottom, kLeft, kRight, kTopCorners, kCorners, kPoint };

struct SoftPin {
    PinPlace place = PinPlace::kTop;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // [m] in the object's frame; for kPoint
    /// 0: the nodes are fixed in the world. Otherwise the rigid object to which the nodes are
    /// anchored; forces act on both. Removing that object frees the nodes.
    std::uint32_t object_id = 0;
};

inline constexpr std::size_t kMaxSoftNodes = 1500;       // per object
inline constexpr std::size_t kMaxSoftNodesTotal = 4000;  // per world

struct SoftObject {
    std::uint32_t id = 0;
    SoftShape shape = SoftShape::kCloth;
    /// [m] cloth: width along local x, height along z, thickness; rope: length, diameter, distance
    /// between its ends at the start (it lies along local x and hangs towards -z); ball: diameters;
    /// box: full extents; model: unused.
    Eigen::Vector3d size_m{1.0, 1.0, 0.01};
    /// [m] kCloth only: distance between its left and right edges at the start. In between it hangs
    /// towards local -y, with a roll of 90 degrees: down. Empty: its width, so that it starts flat.
    std::optional<double> span_m;
    /// kModel only: closed, oriented outwards; one node per vertex.
    geometry::TriangleMesh model;
    double spacing_m = 0.05;  // approximate distance of neighbouring nodes; unused for a model
    double mass_kg = 0.3;
    double stiffness = 0.5;   // 0: softest, 1: stiffest
    double damping_hz = 0.5;  // decay rate of the velocity [1/s]
    double friction = 0.6;
    std::vector<SoftPin> pins;
    geometry::RigidTransform world_from_object{};  // start pose; `reset` returns the object to it
    /// [m] in the world, per node: where they start. Empty: in the rest shape at the start pose.
    std::vector<Eigen::Vector3f> start_nodes;
};

/// Returns where it starts: the middle of its start nodes, or the place of its start pose [m].
Eigen::Vector3d start_place(const SoftObject& object);

/// Returns the filled volume at rest; for cloth and rope with their thickness.
double volume_m3(const SoftObject& object);

/// Returns the first problem: a number that is not finite or out of range (sizes and spans 1 cm to
/// 20 m, spacings 1 cm to 1 m, masses 1 g to 100 kg), more than `kMaxSoftNodes` nodes, a pin that
/// does not fit the shape, a model that is not closed or less than 1 cm across, or another number
/// of start nodes than the shape has. Empty if the object is valid.
std::optional<ObjectProblem> find_problem(const SoftObject& object);

/// The constant part of a soft object.
struct SoftTopology {
    std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
    std::vector<std::array<std::uint32_t, 2>> segments;   // of a rope
    double radius_m = 0.0;                                // of a rope
};

}  // namespace atrium::physics
