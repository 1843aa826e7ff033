#pragma once

#include "world_server/physics/state/world_state.hpp"

#include <vector>

class btRigidBody;
class btSoftRigidDynamicsWorld;

namespace atrium::physics {

class ObjectBody;

ObjectMotion motion_of(ObjectBody& body);
void set_motion(const ObjectMotion& motion, ObjectBody& body);

/// Removes everything that collides from the world and adds it again, `bodies` last and in the
/// given order. Later results then depend only on motion, not on Bullet's cache of contacts and
/// pairs or on the order of earlier additions. Costs the accumulated impulses of resting contacts,
/// which build up again within some ticks.
void forget_history(btSoftRigidDynamicsWorld& world, const std::vector<btRigidBody*>& bodies);

}  // namespace atrium::physics
