#include "world_server/physics/rigid/collision_shape.hpp"

#include "core/geometry/aabb.hpp"
#include "core/geometry/alignment.hpp"
#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <LinearMath/btConvexHullComputer.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cassert>
#include <limits>

namespace atrium::physics {
namespace {

std::unique_ptr<btCollisionShape> make_simple(const RigidObject& object) {
    const btVector3 size = to_bullet(object.size_m);
    switch (object.shape) {
        case ObjectShape::kSphere:
            return std::make_unique<btSphereShape>(size.x() / 2);
        case ObjectShape::kCylinder: {
            auto shape = std::make_unique<btCylinderShapeZ>(size / 2);
            shape->setSafeMargin(size / 2);
            return shape;
        }
        case ObjectShape::kCapsule:
            return std::make_unique<btCapsuleShapeZ>(size.x() / 2, size.z() - size.x());
        case ObjectShape::kPlane:
            return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
        default:
            break;
    }
    auto shape = std::make_unique<btBoxShape>(size / 2);
    shape->setSafeMargin(size / 2);
    return shape;
}

double inner_radius(const geometry::TriangleMesh& part) {
    return 0.5 * geometry::bounds(part).size().minCoeff();
}

// Makes one hull in the body frame.
std::unique_ptr<btConvexHullShape> make_hull(const geometry::TriangleMesh& part,
                                             const geometry::RigidTransform& body_from_object,
                                             const HullOptions& options) {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& v : part.vertices) points.push_back(body_from_object * v);
    const double margin =
        std::min(options.margin_m, options.margin_per_radius * inner_radius(part));
    btConvexHullComputer computer;
    // shrinks by at most a quarter of the inner radius: a thin wedge stays a wedge
    const btScalar shrunk_by = computer.compute(points.front().data(),
                                                static_cast<int>(sizeof(Eigen::Vector3d)),
                                                static_cast<int>(points.size()),
                                                btScalar(margin),
                                                btScalar(0.25));
    auto hull = std::make_unique<btConvexHullShape>();
    if (shrunk_by > 0) {
        for (int v = 0; v < computer.vertices.size(); ++v)
            hull->addPoint(computer.vertices[v], /*recalculateLocalAabb=*/false);
        hull->setMargin(shrunk_by);
    } else {
        for (const Eigen::Vector3d& p : points) hull->addPoint(to_bullet(p), false);
        hull->setMargin(btScalar(margin));
    }
    hull->recalcLocalAabb();
    return hull;
}

// Returns the rotation from the principal axes. Identity if the frame's own axes are principal, as
// for a box.
Eigen::Quaterniond rotation_of_axes(const Eigen::Matrix3d& inertia, Eigen::Vector3d& moments) {
    const double size = inertia.diagonal().maxCoeff();
    const Eigen::Matrix3d off = inertia - Eigen::Matrix3d(inertia.diagonal().asDiagonal());
    if (off.cwiseAbs().maxCoeff() <= 1e-4 * size) {
        moments = inertia.diagonal();
        return Eigen::Quaterniond::Identity();
    }
    auto [values, axes] = geometry::principal_axes(inertia);
    moments = values;
    if (axes.determinant() < 0.0) axes.col(2) = -axes.col(2);
    return Eigen::Quaterniond(axes).normalized();
}

}  // namespace

CollisionShape::CollisionShape(const RigidObject& object, const HullOptions& options) {
    assert(!find_problem(object));
    if (object.shape == ObjectShape::kConvex || object.shape == ObjectShape::kCompound) {
        make_parts(object, options);
        return;
    }
    shape_ = make_simple(object);
    inner_radius_m_ = 0.5 * object.size_m.minCoeff();
    if (object.mass_kg > 0.0) {
        btVector3 inertia(0, 0, 0);
        shape_->calculateLocalInertia(btScalar(object.mass_kg), inertia);
        inertia_ = from_bullet(inertia);
    }
}

CollisionShape::~CollisionShape() = default;

void CollisionShape::make_parts(const RigidObject& object, const HullOptions& options) {
    const MassProperties mass = mass_properties(*object.parts);
    Eigen::Vector3d moments;
    object_from_body_.rotation = rotation_of_axes(mass.inertia, moments);
    object_from_body_.translation = mass.centre;
    inertia_ = object.mass_kg / mass.volume_m3 * moments;
    const geometry::RigidTransform body_from_object = object_from_body_.inverse();
    inner_radius_m_ = std::numeric_limits<double>::infinity();
    for (const geometry::TriangleMesh& part : *object.parts)
        inner_radius_m_ = std::min(inner_radius_m_, inner_radius(part));
    if (object.parts->size() == 1) {
        shape_ = make_hull(object.parts->front(), body_from_object, options);
        return;
    }
    auto compound = std::make_unique<btCompoundShape>(
        /*enableDynamicAabbTree=*/true, static_cast<int>(object.parts->size()));
    for (const geometry::TriangleMesh& part : *object.parts) {
        parts_.push_back(make_hull(part, body_from_object, options));
        compound->addChildShape(btTransform::getIdentity(), parts_.back().get());
    }
    shape_ = std::move(compound);
}

Eigen::Vector3d centre_of_mass(const RigidObject& object) {
    return object.world_from_object * CollisionShape(object).object_from_body().translation;
}

}  // namespace atrium::physics
