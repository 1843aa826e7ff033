#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::physics {

enum class SoftShape : std::uint8_t { kCloth, kRope, kBall, kBox, kModel };

/// Which nodes a pin holds. Of a cloth: its edges and corners, top is +z, right is +x. Of a rope:
/// left is its start, right its end. Of anything: the node nearest to a point.
enum class PinPlace : std::uint8_t { kTop, kBottom, kLeft, kRight, kTopCorners, kCorners, kPoint };

struct SoftPin {
    PinPlace place = PinPlace::kTop;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // [m] in the object's frame; of kPoint
    /// 0: the nodes stay where they start. Else the rigid object that they are tied to: what pulls
    /// at one pulls at the other. When it is removed they are free.
    std::uint32_t object_id = 0;
};

inline constexpr std::size_t kMaxSoftNodes = 1500;       // of one soft object
inline constexpr std::size_t kMaxSoftNodesTotal = 4000;  // of a world

struct SoftObject {
    std::uint32_t id = 0;
    SoftShape shape = SoftShape::kCloth;
    /// [m] cloth: width along local x, height along z, thickness; rope: length, diameter, distance
    /// of its ends where it starts (it lies along local x and hangs towards -z); ball: diameters;
    /// box: full extents; model: unused.
    Eigen::Vector3d size_m{1.0, 1.0, 0.01};
    /// kModel: closed and oriented outwards, one node per vertex; else unused.
    geometry::TriangleMesh model;
    double spacing_m = 0.05;  // of neighbouring nodes, about; unused of a model
    double mass_kg = 0.3;
    double stiffness = 0.5;   // 0: as soft as it can be, 1: as stiff
    double damping_hz = 0.5;  // share of the velocity that is lost in a second
    double friction = 0.6;
    std::vector<SoftPin> pins;
    geometry::RigidTransform world_from_object{};  // where it starts, and where `reset` puts it
};

/// Of the thing at rest, filled; of a cloth and a rope with its thickness.
double volume_m3(const SoftObject& object);

/// A number is not finite or out of range (sizes 1 cm to 20 m, spacings 1 cm to 1 m, masses 1 g to
/// 100 kg), there would be more than `kMaxSoftNodes` nodes, a pin does not fit the shape, or the
/// model is not closed or less than 1 cm across.
std::optional<ObjectProblem> find_problem(const SoftObject& object);

/// What of a soft object never changes.
struct SoftTopology {
    std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
    std::vector<std::array<std::uint32_t, 2>> segments;   // of a rope
    double radius_m = 0.0;                                // of a rope
};

}  // namespace atrium::physics
