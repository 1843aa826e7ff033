#pragma once

#include <Eigen/Core>
#include <LinearMath/btVector3.h>

#include <cstdint>

class btSoftBody;

namespace atrium::physics {

/// A point of a soft body: a node, the centre of a face, or any other weighted mean of three nodes.
struct SoftSample {
    std::uint32_t nodes[3];
    btScalar weights[3];  // add up to 1
};

/// Motion and inverse effective mass of a point.
struct SampleMotion {
    btVector3 position;     // [m] world
    btVector3 velocity;     // [m/s]
    btScalar inverse_mass;  // inverse effective mass; 0: fixed
};

SampleMotion motion_of(const btSoftBody& soft, const SoftSample& sample);

/// Moves the nodes of the sample as `impulse` [kg m] at that point would.
void move(btSoftBody& soft, const SoftSample& sample, const btVector3& impulse);

/// Returns the mean of all nodes [m].
Eigen::Vector3d centre_of(const btSoftBody& soft);

}  // namespace atrium::physics
