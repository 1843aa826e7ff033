#pragma once

#include "world_server/physics/options/rigid_options.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

class btCollisionShape;

namespace atrium::physics {

/// A point on a body's surface, in the body frame.
struct BodySample {
    Eigen::Vector3f point;
    // unit length: the normal; at a tip the mean of the normals around it
    Eigen::Vector3f outwards;
};

/// Samples the surface of a convex or compound shape. Casts a lattice of rays from six sides and
/// adds the tips, edges and corners that the lattice misses. Deterministic.
std::vector<BodySample> sample_body(const btCollisionShape& shape,
                                    const BodySamplingOptions& options);

/// Returns `num` unit vectors that are spread evenly over the sphere.
std::vector<Eigen::Vector3f> even_directions(std::size_t num);

}  // namespace atrium::physics
