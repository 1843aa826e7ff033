#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/options/world_options.hpp"
#include "world_server/physics/rigid/collision_shape.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"
#include "world_server/physics/state/world_state.hpp"

#include <memory>

class btRigidBody;
class btTransform;
class btVector3;

namespace atrium::physics {

/// A rigid object in the Bullet world.
class ObjectBody {
public:
    /// `find_problem(object)` must be empty.
    ObjectBody(const RigidObject& object, const WorldOptions& options);
    ~ObjectBody();
    ObjectBody(const ObjectBody&) = delete;
    ObjectBody& operator=(const ObjectBody&) = delete;

    btRigidBody& body() { return *body_; }
    const RigidObject& object() const { return object_; }
    bool moves() const { return object_.mass_kg > 0.0; }
    /// Half of the smallest extent [m]; of a compound, half of the smallest extent of its thinnest
    /// part.
    double inner_radius_m() const { return shape_.inner_radius_m(); }
    /// Object frame from body frame. The body frame is centred at the centre of mass.
    const geometry::RigidTransform& object_from_body() const { return shape_.object_from_body(); }
    /// Centre of mass in the world [m].
    Eigen::Vector3d centre() const;
    RigidState state() const;
    /// Sets pose and velocities and wakes the object. Ignores `state.id`.
    void set_state(const RigidState& state);
    /// Sets the pose to which `reset_to_start` returns.
    void set_start(const geometry::RigidTransform& pose) { object_.world_from_object = pose; }
    /// Sets mass and surface. A fixed object stays fixed, a movable one movable.
    void set_material(double mass_kg, double friction, double restitution);
    /// Returns the object to its start pose, at rest and awake.
    void reset_to_start();
    bool is_finite() const;
    /// Limits speed and spin (`WorldOptions`).
    void limit_speeds(const WorldOptions& options);
    /// Limits the depenetration speed of the last step (`WorldOptions`). Call when Bullet has moved
    /// the body, before anything else changes its velocity.
    void limit_depenetration(const Eigen::Vector3d& centre_before, const WorldOptions& options);

private:
    btTransform start() const;
    void move_to(const btTransform& world_from_body,
                 const btVector3& linear_velocity,
                 const btVector3& angular_velocity);

    RigidObject object_;
    CollisionShape shape_;
    Eigen::Vector3d inertia_;  // principal moments [kg m^2]
    std::unique_ptr<btRigidBody> body_;
};

}  // namespace atrium::physics
