#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace atrium::physics {

/// Computes the convex hull of points as a closed mesh. Its vertices are some of the points.
///
/// If the hull has more than `max_vertices` vertices (`max_vertices` >= 8), the result is the hull
/// of the points that lie furthest out in `max_vertices` directions: both of each axis, so that its
/// extents are those of the points, and others evenly spread. Empty if the points span a volume of
/// less than 1e-9 m^3.
geometry::TriangleMesh convex_hull(const std::vector<Eigen::Vector3d>& points,
                                   std::size_t max_vertices);

/// Mass properties of closed meshes that are filled evenly. Overlapping parts count more than once.
struct MassProperties {
    double volume_m3 = 0.0;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // centre of mass
    /// Inertia about `centre`, along the axes of the meshes' frame, for a density of 1 kg/m^3.
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// Computes mass properties. Exact for polyhedra: sums over the tetrahedra between each triangle
/// and the origin.
MassProperties mass_properties(const std::vector<geometry::TriangleMesh>& parts);

}  // namespace atrium::physics
