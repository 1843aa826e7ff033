#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::test {

/// A viewing cone in exact numbers: all half-lines from `centre` through the inside of closed loops
/// of rays, by the even-odd rule. The loops are simple and do not touch each other.
struct ExactCone {
    Eigen::Vector3d centre;
    Eigen::Vector3d axis;  // all rays are on its side
    std::vector<std::vector<Eigen::Vector3d>> loops;
};

/// The intersection of all cones.
struct ExactSolid {
    double volume_m3 = 0.0;
    std::size_t num_components = 0;  // connected insides
    /// Of the surface: vertices - edges + faces, where faces are polygons with or without holes.
    std::int64_t euler_characteristic = 0;
    std::vector<Eigen::Vector3d> vertices;
    std::size_t num_edges = 0;
    bool is_cut = false;  // it reaches the plane that ends a cone
};

/// Uses Nef polyhedra over rational numbers (CGAL): no rounding before the last step, no tolerance,
/// and no code shared with the hull. Cones end at depth `far_m`. Takes about a second for six cones
/// of 25 rays.
ExactSolid intersect_exactly(std::span<const ExactCone> cones, double far_m);

}  // namespace atrium::test
