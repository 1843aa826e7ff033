#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <functional>

namespace atrium::simulation {

/// Signed distance [m], negative inside. Must be exact only near its zero set.
using DistanceField = std::function<double(const Eigen::Vector3d&)>;

/// Meshes the zero set of `distance` inside `box`, in cells of `cell_m`, by naive surface nets: one
/// vertex per cell that the surface crosses, then moved onto the surface along the gradient.
///
/// The surface must not touch the box. The mesh is closed and 2-manifold: where the surface would
/// touch itself within a cell, the gap is filled. Deterministic.
geometry::TriangleMesh surface_nets(const DistanceField& distance,
                                    const geometry::Aabb& box,
                                    double cell_m);

/// Returns the unit gradient by central differences with `step_m` each way.
Eigen::Vector3d gradient_direction(const DistanceField& distance,
                                   const Eigen::Vector3d& p,
                                   double step_m);

}  // namespace atrium::simulation
