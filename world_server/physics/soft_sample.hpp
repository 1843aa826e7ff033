#pragma once

#include <Eigen/Core>
#include <LinearMath/btVector3.h>

#include <cstdint>

class btSoftBody;

namespace atrium::physics {

/// A place on a soft body: a node, the middle of a face, or any other place between three nodes.
struct SoftSample {
    std::uint32_t nodes[3];
    btScalar weights[3];  // add up to 1
};

/// How a place moves that is free to.
struct SampleMotion {
    btVector3 position;  // [m] world
    btVector3 velocity;  // [m/s]
    btScalar share;      // inverse of the mass that it is felt with; 0: does not move
};

SampleMotion motion_of(const btSoftBody& soft, const SoftSample& sample);

/// Moves the nodes of the sample as `impulse` [kg m] at that place does.
void move(btSoftBody& soft, const SoftSample& sample, const btVector3& impulse);

/// Mean of all nodes [m].
Eigen::Vector3d centre_of(const btSoftBody& soft);

}  // namespace atrium::physics
