#pragma once

#include "core/geometry/surface_tree.hpp"
#include "world_server/physics/rigid/rigid_object.hpp"
#include "world_server/physics/soft/soft_object.hpp"

namespace atrium::physics {

/// Returns the shortest way out of `other` for `moving`, both at their start [m]; 0 if they do not
/// overlap. `moving` is no plane. `find_problem` must be empty for both.
double overlap_m(const RigidObject& moving, const RigidObject& other);

/// Like above, out of each triangle of solid scenery, in the world.
double overlap_m(const RigidObject& moving, const geometry::TriangleMesh& scenery);

/// Returns how deep `moving` is inside solid bodies, in the world [m]: the distance of its deepest
/// point from their surface. Looks at the middle of each convex part and at its outermost points
/// along its axes and diagonals. `moving` is no plane.
double depth_m(const RigidObject& moving, const geometry::SurfaceTree& bodies);

/// Like above, for the deepest node of a soft object. Nodes that a pin holds do not count.
double overlap_m(const SoftObject& soft, const RigidObject& fixed);

/// Like above, for the deepest node that `pin` holds.
double pinned_depth_m(const SoftObject& soft, const SoftPin& pin, const RigidObject& rigid);

/// Whether a cloth or rope starts with `rigid` through it: between two neighbouring nodes that are
/// both outside, so that it stays skewered. Edges at a node that a pin holds do not count, nor does
/// what starts as a saved world had it.
bool is_skewered(const SoftObject& soft, const RigidObject& rigid);

/// Like `depth_m` above, for the nodes of a soft object. Nodes that a pin holds do not count.
double depth_m(const SoftObject& soft, const geometry::SurfaceTree& bodies);

}  // namespace atrium::physics
