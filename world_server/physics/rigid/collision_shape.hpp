#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/options/rigid_options.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"

#include <Eigen/Core>

#include <memory>
#include <vector>

class btCollisionShape;

namespace atrium::physics {

/// Holds Bullet's collision shape of an object. The body frame has its origin at the centre of mass
/// and its axes along the principal axes of inertia. Bullet uses this frame.
class CollisionShape {
public:
    /// `find_problem(object)` must be empty.
    explicit CollisionShape(const RigidObject& object, const HullOptions& options = {});
    ~CollisionShape();
    CollisionShape(const CollisionShape&) = delete;
    CollisionShape& operator=(const CollisionShape&) = delete;

    btCollisionShape& shape() { return *shape_; }
    /// Identity unless the shape is convex or compound.
    const geometry::RigidTransform& object_from_body() const { return object_from_body_; }
    /// Principal moments about the body's axes [kg m^2]. Zero if the object is static.
    const Eigen::Vector3d& inertia() const { return inertia_; }
    /// Half of the smallest extent [m]; of a compound, half of the smallest extent of its thinnest
    /// part.
    double inner_radius_m() const { return inner_radius_m_; }

private:
    void make_parts(const RigidObject& object, const HullOptions& options);
    std::vector<std::unique_ptr<btCollisionShape>> parts_;  // parts of a compound; empty otherwise
    std::unique_ptr<btCollisionShape> shape_;
    geometry::RigidTransform object_from_body_;
    Eigen::Vector3d inertia_ = Eigen::Vector3d::Zero();
    double inner_radius_m_ = 0.0;
};

/// Returns the centre of mass of an object at its start pose [m, world]. `find_problem(object)`
/// must be empty.
Eigen::Vector3d centre_of_mass(const RigidObject& object);

}  // namespace atrium::physics
