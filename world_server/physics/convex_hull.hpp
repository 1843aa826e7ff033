#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace atrium::physics {

/// The convex hull of points as a closed mesh whose vertices are some of them. Where it would have
/// more than `max_vertices` (at least 8), it is the hull of the points furthest out in as many
/// directions, evenly spread. Empty where the points span no volume, or less than 1e-9 m^3.
geometry::TriangleMesh convex_hull(const std::vector<Eigen::Vector3d>& points,
                                   std::size_t max_vertices);

/// Of matter that fills closed meshes evenly. Where meshes overlap it counts more than once.
struct MassProperties {
    double volume_m3 = 0.0;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of mass
    /// Inertia about `centre`, along the axes of the meshes' frame, for a density of 1 kg/m^3.
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// Exact for polyhedra: sums over the tetrahedra between each triangle and the origin.
MassProperties mass_properties(const std::vector<geometry::TriangleMesh>& parts);

}  // namespace atrium::physics
