#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::physics {

enum class ObjectShape : std::uint8_t {
    kBox,
    kSphere,
    kCylinder,
    kCapsule,
    kPlane,
    kConvex,   // convex hull of one part
    kCompound  // several parts in a rigid union
};

inline constexpr std::size_t kMaxHullVertices = 64;  // per part
inline constexpr std::size_t kMaxHullParts = 64;     // per object

struct RigidObject {
    std::uint32_t id = 0;
    ObjectShape shape = ObjectShape::kBox;
    /// [m] box: full extents; sphere: three times the diameter; cylinder, capsule: diameter,
    /// diameter, height along local z (including a capsule's caps); plane: unused, infinite through
    /// the origin with normal +z; convex, compound: full extents as returned by `extents_of`.
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
    double mass_kg = 0.0;  // 0: static; a plane must be static
    double friction = 0.6;
    double restitution = 0.2;
    geometry::RigidTransform world_from_object{};  // start pose; `reset` returns the object to it
    /// Lever arm with which contacts resist rolling [m], if the other side has friction 1.
    double rolling_friction_m = 0.0005;
    double drag_per_s = 0.02;  // share of the speed that air drag takes per second
    /// Convex, compound: hulls (`convex_hull`) in the object's frame. The centre of mass may be
    /// anywhere. Shared by all objects of one model.
    std::shared_ptr<const std::vector<geometry::TriangleMesh>> parts{};
};

/// Returns the full extents of all vertices along the axes [m].
Eigen::Vector3d extents_of(const std::vector<geometry::TriangleMesh>& parts);

/// Returns the volume; zero for a plane.
double volume_m3(const RigidObject& object);

/// Names an invalid field of an object and its allowed values.
struct ObjectProblem {
    std::string_view field;
    std::string allowed;
};

/// Returns the first problem: a number that is not finite, a size outside 1 cm .. 20 m or wrong for
/// the shape, a mass outside 0 .. 10 t, a density outside 1 .. 30000 kg/m^3, a plane with a mass,
/// or missing, too many or too large parts. Empty if the object is valid.
std::optional<ObjectProblem> find_problem(const RigidObject& object);

}  // namespace atrium::physics
