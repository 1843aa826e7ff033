#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

class btRigidBody;
class btSoftRigidDynamicsWorld;

namespace atrium::physics {

class ObjectBody;

/// All that changes of a rigid object, in the numbers that Bullet computes with, so that nothing is
/// lost between saving and restoring.
struct ObjectMotion {
    std::uint32_t id = 0;
    Eigen::Vector3f position_m = Eigen::Vector3f::Zero();        // of the body's frame, world
    Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();      // world from body
    Eigen::Vector3f linear_velocity = Eigen::Vector3f::Zero();   // [m/s] world
    Eigen::Vector3f angular_velocity = Eigen::Vector3f::Zero();  // [rad/s] world
    std::int32_t activation = 1;  // Bullet's: awake, about to sleep, asleep
    float idle_s = 0.0F;          // how long it has been slow enough to fall asleep

    bool operator==(const ObjectMotion&) const = default;
};

/// All that changes of a soft object.
struct SoftState {
    std::uint32_t id = 0;
    std::vector<Eigen::Vector3f> positions;   // [m] world, one per node
    std::vector<Eigen::Vector3f> velocities;  // [m/s] world, one per node
    std::int32_t num_torn_ticks = 0;          // how long it has been stretched out of all shape

    bool operator==(const SoftState&) const = default;
};

/// All that changes of a world, but for people, who come back with their next mesh, and for what is
/// held by a grab.
struct WorldState {
    std::uint64_t tick = 0;
    std::vector<ObjectMotion> objects;  // ids rise
    std::vector<SoftState> soft;

    bool operator==(const WorldState&) const = default;
};

ObjectMotion motion_of(ObjectBody& body);
/// Numbers are finite, the rotation is one, the activation is one of Bullet's.
bool is_valid(const ObjectMotion& motion);
/// Numbers are finite, and there are as many velocities as positions.
bool is_valid(const SoftState& motion);
void set_motion(const ObjectMotion& motion, ObjectBody& body);

/// Takes all that collides out of the world and puts it back, `bodies` last and in the order given,
/// so that what happens next depends on motion alone and not on what Bullet remembers of contacts,
/// of pairs and of the order in which bodies came and went. Costs the accumulated impulses of
/// resting contacts, which build up again within some ticks.
void forget_history(btSoftRigidDynamicsWorld& world, const std::vector<btRigidBody*>& bodies);

}  // namespace atrium::physics
