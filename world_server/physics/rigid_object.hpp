#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace atrium::physics {

enum class ObjectShape : std::uint8_t {
    kBox,
    kSphere,
    kCylinder,
    kCapsule,
    kPlane,
    kConvex,   // the convex hull of one part
    kCompound  // of several parts that stay together
};

inline constexpr std::size_t kMaxHullVertices = 64;  // of one part
inline constexpr std::size_t kMaxHullParts = 64;     // of one object

struct RigidObject {
    std::uint32_t id = 0;
    ObjectShape shape = ObjectShape::kBox;
    /// [m] box: full extents; sphere: diameter thrice; cylinder, capsule: diameter, diameter,
    /// height along local z (a capsule's height includes its caps); plane: infinite, through the
    /// origin, normal +z, unused; convex, compound: full extents, as `extents_of` has them.
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
    double mass_kg = 0.0;  // 0: does not move; a plane must not
    double friction = 0.6;
    double restitution = 0.2;
    geometry::RigidTransform world_from_object{};  // where it starts, and where `reset` puts it
    /// [m] The lever at which contacts resist rolling, where the other side has friction 1.
    double rolling_friction_m = 0.0005;
    double drag_per_s = 0.02;  // by which a free object loses speed to the air
    /// Convex, compound: hulls (`convex_hull`) in the object's frame, which need not be about the
    /// centre of mass. Shared by objects of one model.
    std::shared_ptr<const std::vector<geometry::TriangleMesh>> parts{};
};

/// Full extents of all vertices along the axes [m].
Eigen::Vector3d extents_of(const std::vector<geometry::TriangleMesh>& parts);

/// Zero for a plane.
double volume_m3(const RigidObject& object);

/// What is wrong with an object, and what would be right.
struct ObjectProblem {
    std::string_view field;
    std::string_view allowed;
};

/// A number is not finite, a size is outside 1 cm .. 20 m or does not fit the shape, a mass is
/// outside 0 .. 10 t, a density outside 1 .. 30000 kg/m^3, a plane has a mass, or parts are too
/// many, too large or missing.
std::optional<ObjectProblem> find_problem(const RigidObject& object);

}  // namespace atrium::physics
