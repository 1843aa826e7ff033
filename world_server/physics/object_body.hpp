#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "world_server/physics/world.hpp"

#include <memory>

class btCollisionShape;
class btRigidBody;

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
    /// Half of the smallest extent [m].
    double inner_radius_m() const { return inner_radius_m_; }
    RigidState state() const;
    /// Back to where it started, at rest and awake.
    void put_back();
    bool is_finite() const;
    /// Keeps the motion of the tick that has just been within its limits.
    void limit_motion(const Eigen::Vector3d& position_before, const WorldOptions& options);

private:
    RigidObject object_;
    double inner_radius_m_ = 0.0;
    std::unique_ptr<btCollisionShape> shape_;
    std::unique_ptr<btRigidBody> body_;
};

}  // namespace atrium::physics
