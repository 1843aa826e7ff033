#include "world_server/physics/rigid/rigid_object.hpp"

#include "core/base/allowed_mass.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/simple_volumes.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace atrium::physics {
namespace {

constexpr double kMinSizeM = 0.01;
constexpr double kMaxSizeM = 20.0;
constexpr double kMinPartM = 0.004;  // smallest extent of a part

std::string mass_rule(double volume_m3) {
    const MassRange range = allowed_masses(volume_m3);
    std::ostringstream text;
    text << "must give a mass of " << range.least_kg << " to " << range.most_kg
         << " kg (a density of " << kMinDensity_kg_per_m3 << " to " << kMaxDensity_kg_per_m3
         << " kg/m^3), or 0 for fixed";
    return text.str();
}

bool has_parts(ObjectShape shape) {
    return shape == ObjectShape::kConvex || shape == ObjectShape::kCompound;
}

std::optional<ObjectProblem> find_parts_problem(const RigidObject& object) {
    if (!object.parts || object.parts->empty())
        return ObjectProblem{"model", "must have a part with a volume"};
    const auto& parts = *object.parts;
    if (object.shape == ObjectShape::kConvex && parts.size() > 1)
        return ObjectProblem{"model", "must be one part for a convex shape"};
    if (parts.size() > kMaxHullParts) return ObjectProblem{"model", "must have at most 64 parts"};
    for (const geometry::TriangleMesh& part : parts) {
        if (part.vertices.size() > kMaxHullVertices)
            return ObjectProblem{"model", "must have at most 64 vertices in each part"};
        // written to reject NaN
        for (const Eigen::Vector3d& v : part.vertices) {
            if (!(v.cwiseAbs().maxCoeff() <= kMaxSizeM))
                return ObjectProblem{"model", "must be within 20 m of its origin"};
        }
        if (!(geometry::bounds(part).size().minCoeff() >= kMinPartM))
            return ObjectProblem{"model", "must have parts of at least 4 mm in every direction"};
    }
    if (!object.size_m.isApprox(extents_of(parts), 1e-3))
        return ObjectProblem{"size_m", "must be the extents of the parts"};
    return std::nullopt;
}

std::optional<ObjectProblem> find_size_problem(const RigidObject& object) {
    const Eigen::Vector3d& s = object.size_m;
    if (object.shape == ObjectShape::kPlane) return std::nullopt;
    if ((s.array() < kMinSizeM).any() || (s.array() > kMaxSizeM).any()) {
        return ObjectProblem{"size_m", "must be 0.01 m to 20 m"};
    }
    if (has_parts(object.shape)) return find_parts_problem(object);
    if (object.shape == ObjectShape::kBox) return std::nullopt;
    const double tolerance_m = 1e-6 * s.x();
    if (std::abs(s.x() - s.y()) > tolerance_m) {
        return ObjectProblem{"size_m", "must have one diameter: the first two are equal"};
    }
    if (object.shape == ObjectShape::kSphere && std::abs(s.x() - s.z()) > tolerance_m) {
        return ObjectProblem{"size_m", "must be three equal diameters for a sphere"};
    }
    if (object.shape == ObjectShape::kCapsule && s.z() < s.x()) {
        return ObjectProblem{"size_m", "must be at least as high as wide for a capsule"};
    }
    return std::nullopt;
}

std::optional<ObjectProblem> find_number_problem(const RigidObject& object) {
    const geometry::RigidTransform& pose = object.world_from_object;
    if (!object.size_m.allFinite()) return ObjectProblem{"size_m", "must be finite"};
    if (!pose.translation.allFinite()) return ObjectProblem{"position_m", "must be finite"};
    // written to reject NaN
    if (!(std::abs(pose.rotation.norm() - 1.0) <= 1e-3)) {
        return ObjectProblem{"rotation", "must be a quaternion of length 1"};
    }
    if (!(object.friction >= 0.0 && object.friction <= 10.0)) {
        return ObjectProblem{"friction", "must be 0 to 10"};
    }
    if (!(object.restitution >= 0.0 && object.restitution <= 1.0)) {
        return ObjectProblem{"restitution", "must be 0 to 1"};
    }
    if (!(object.rolling_friction_m >= 0.0 && object.rolling_friction_m <= 1.0)) {
        return ObjectProblem{"rolling_friction_m", "must be 0 m to 1 m"};
    }
    if (!(object.drag_per_s >= 0.0 && object.drag_per_s <= 0.9)) {
        return ObjectProblem{"drag_per_s", "must be 0 to 0.9"};
    }
    return std::nullopt;
}

}  // namespace

Eigen::Vector3d extents_of(const std::vector<geometry::TriangleMesh>& parts) {
    geometry::Aabb box;
    for (const geometry::TriangleMesh& part : parts) {
        for (const Eigen::Vector3d& v : part.vertices) box.add(v);
    }
    return box.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.size());
}

double volume_m3(const RigidObject& object) {
    const Eigen::Vector3d& s = object.size_m;
    switch (object.shape) {
        case ObjectShape::kPlane:
            return 0.0;
        case ObjectShape::kSphere:
            return geometry::sphere_volume(s.x());
        case ObjectShape::kCylinder:
            return geometry::cylinder_volume(s.x(), s.z());
        case ObjectShape::kCapsule:
            return geometry::capsule_volume(s.x(), s.z());
        case ObjectShape::kConvex:
        case ObjectShape::kCompound:
            return object.parts ? mass_properties(*object.parts).volume_m3 : 0.0;
        case ObjectShape::kBox:
            break;
    }
    return s.prod();
}

std::optional<ObjectProblem> find_problem(const RigidObject& object) {
    if (const auto problem = find_number_problem(object)) return problem;
    // before the mass, which may follow from the size
    if (const auto problem = find_size_problem(object)) return problem;
    if (object.mass_kg == 0.0) return std::nullopt;
    if (object.shape == ObjectShape::kPlane)
        return ObjectProblem{"mass_kg", "must be 0 for a plane"};
    const double density = object.mass_kg / volume_m3(object);
    if (density >= kMinDensity_kg_per_m3 && density <= kMaxDensity_kg_per_m3 &&
        object.mass_kg <= kMaxObjectMass_kg)
        return std::nullopt;
    return ObjectProblem{"mass_kg", mass_rule(volume_m3(object))};
}

}  // namespace atrium::physics
