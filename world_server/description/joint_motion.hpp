#pragma once

#include "world_server/description/world_description.hpp"

#include <optional>

namespace atrium::world_server {

/// What a hinge or slider moves. Both may be able to move; `moving` is `a` then.
struct JointMotion {
    const WorldObject* moving = nullptr;
    const WorldObject* other = nullptr;  // null: the world
    double sign = 1.0;                   // of its motion, as the joint's limits count: -1 for `b`
};

/// Empty for other joints, and if both objects are fixed.
std::optional<JointMotion> motion_of(const physics::Joint& joint, const WorldDescription& world);

/// Returns how far the joint lets its object move in a direction, +1 or -1 [rad of a hinge, m of a
/// slider]; infinite without limits.
double reach(const physics::Joint& joint, double direction);

/// Returns the pose of the moving object when the joint stands at `way` [rad, m].
geometry::RigidTransform pose_at(double way,
                                 const physics::Joint& joint,
                                 const JointMotion& motion);

}  // namespace atrium::world_server
