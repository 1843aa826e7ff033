#pragma once

#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace atrium::physics {

struct RigidState {
    std::uint32_t id = 0;
    geometry::RigidTransform world_from_object;
    Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();   // [m/s] world
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // [rad/s] world
};

/// Variable state of a rigid object, in Bullet's precision: saving and restoring loses nothing.
struct ObjectMotion {
    std::uint32_t id = 0;
    Eigen::Vector3f position_m = Eigen::Vector3f::Zero();        // body frame, in the world
    Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();      // world from body
    Eigen::Vector3f linear_velocity = Eigen::Vector3f::Zero();   // [m/s] world
    Eigen::Vector3f angular_velocity = Eigen::Vector3f::Zero();  // [rad/s] world
    std::int32_t activation = 1;  // Bullet's activation state: awake, about to sleep, asleep
    float idle_s = 0.0F;          // time for which it has been slow enough to fall asleep

    bool operator==(const ObjectMotion&) const = default;
};

/// Variable state of a soft object.
struct SoftState {
    std::uint32_t id = 0;
    std::vector<Eigen::Vector3f> positions;   // [m] world, one per node
    std::vector<Eigen::Vector3f> velocities;  // [m/s] world, one per node
    std::int32_t num_torn_ticks = 0;          // ticks for which it has been stretched out of shape

    bool operator==(const SoftState&) const = default;
};

/// Variable state of a world, without people and grabs. People return with their next mesh.
struct WorldState {
    std::uint64_t tick = 0;
    std::vector<ObjectMotion> objects;  // ascending ids
    std::vector<SoftState> soft;

    bool operator==(const WorldState&) const = default;
};

/// True if all numbers are finite, the rotation is orthonormal, and the activation state is one of
/// Bullet's.
bool is_valid(const ObjectMotion& motion);
/// True if all numbers are finite and there are as many velocities as positions.
bool is_valid(const SoftState& motion);
}  // namespace atrium::physics
