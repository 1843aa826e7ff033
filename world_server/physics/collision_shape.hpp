#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/rigid_object.hpp"

#include <Eigen/Core>

#include <memory>
#include <vector>

class btCollisionShape;

namespace atrium::physics {

/// Bullet's shape of an object, about its centre of mass and along its principal axes: the frame in
/// which Bullet knows a body.
class CollisionShape {
public:
    /// `object` must have no problem.
    explicit CollisionShape(const RigidObject& object);
    ~CollisionShape();
    CollisionShape(const CollisionShape&) = delete;
    CollisionShape& operator=(const CollisionShape&) = delete;

    btCollisionShape& shape() { return *shape_; }
    /// Identity for shapes that are not made of parts.
    const geometry::RigidTransform& object_from_body() const { return object_from_body_; }
    /// About the axes of the body [kg m^2]; zero where the object does not move.
    const Eigen::Vector3d& inertia() const { return inertia_; }
    /// Half of the smallest extent, of a compound that of its thinnest part [m].
    double inner_radius_m() const { return inner_radius_m_; }

private:
    void make_parts(const RigidObject& object);
    std::vector<std::unique_ptr<btCollisionShape>> parts_;  // of a compound
    std::unique_ptr<btCollisionShape> shape_;
    geometry::RigidTransform object_from_body_;
    Eigen::Vector3d inertia_ = Eigen::Vector3d::Zero();
    double inner_radius_m_ = 0.0;
};

}  // namespace atrium::physics
