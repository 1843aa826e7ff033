#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

class btCollisionShape;

namespace atrium::physics {

/// A point of a body's surface, in the body's frame.
struct BodySample {
    Eigen::Vector3f point;
    Eigen::Vector3f outwards;  // unit length: the normal, or at a tip the middle of those around it
};

struct BodySamplingOptions {
    double spacing_m = 0.025;
    std::size_t max_samples = 3000;  // a larger surface is sampled more sparsely
};

/// The surface of a convex or compound shape: a lattice cast on it from six sides, and the tips,
/// edges and corners that lattices miss. Deterministic.
std::vector<BodySample> sample_body(const btCollisionShape& shape,
                                    const BodySamplingOptions& options);

/// `num` unit vectors spread evenly over all directions.
std::vector<Eigen::Vector3f> even_directions(std::size_t num);

}  // namespace atrium::physics
