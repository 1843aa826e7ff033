#pragma once

#include <Eigen/Core>

#include <random>

namespace atrium::test {

using Random = std::mt19937_64;  // the same numbers on every platform

inline double between(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

/// Both ends included.
inline int between(Random& random, int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
}

/// Draws each coordinate independently, one after the other, because compilers differ in the order
/// in which they evaluate arguments.
inline Eigen::Vector3d between(Random& random,
                               const Eigen::Vector3d& low,
                               const Eigen::Vector3d& high) {
    Eigen::Vector3d v;
    for (int c = 0; c < 3; ++c) v[c] = between(random, low[c], high[c]);
    return v;
}

inline Eigen::Vector3d random_in_cube(Random& random, double half_side) {
    const Eigen::Vector3d corner = Eigen::Vector3d::Constant(half_side);
    return between(random, -corner, corner);
}

/// A unit vector, uniform over all directions.
inline Eigen::Vector3d random_direction(Random& random) {
    for (;;) {
        const Eigen::Vector3d v = random_in_cube(random, 1.0);
        if (v.norm() < 1.0 && v.norm() > 0.1) return v.normalized();
    }
}

}  // namespace atrium::test
