#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/collision_shape.hpp"
#include "world_server/physics/world.hpp"

#include <memory>

class btRigidBody;
class btTransform;
class btVector3;

namespace atrium::physics {

/// One object of the world with what Bullet knows of it.
class ObjectBody {
public:
    /// `object` must have no problem.
    ObjectBody(const RigidObject& object, const WorldOptions& options);
    ~ObjectBody();
    ObjectBody(const ObjectBody&) = delete;
    ObjectBody& operator=(const ObjectBody&) = delete;

    btRigidBody& body() { return *body_; }
    const RigidObject& object() const { return object_; }
    bool moves() const { return object_.mass_kg > 0.0; }
    /// Half of the smallest extent, of a compound that of its thinnest part [m].
    double inner_radius_m() const { return shape_.inner_radius_m(); }
    /// From the frame that Bullet knows, about the centre of mass, to that of the object.
    const geometry::RigidTransform& object_from_body() const { return shape_.object_from_body(); }
    /// Of mass, in the world [m].
    Eigen::Vector3d centre() const;
    RigidState state() const;
    /// Its id is not looked at; wakes the object.
    void set_state(const RigidState& state);
    /// Back to where it started, at rest and awake.
    void put_back();
    bool is_finite() const;
    /// Keeps the motion of the tick that has just been within its limits.
    void limit_motion(const Eigen::Vector3d& centre_before, const WorldOptions& options);

private:
    btTransform start() const;
    void move_to(const btTransform& world_from_body,
                 const btVector3& linear_velocity,
                 const btVector3& angular_velocity);

    RigidObject object_;
    CollisionShape shape_;
    std::unique_ptr<btRigidBody> body_;
};

}  // namespace atrium::physics
