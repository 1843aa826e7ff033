#pragma once

#include "world_server/physics/rigid/rigid_object.hpp"
#include "world_server/physics/soft/soft_object.hpp"

namespace atrium::physics {

/// Returns the shortest way out of `other` for `moving`, both at their start [m]; 0 if they do not
/// overlap. `moving` is no plane. `find_problem` must be empty for both.
double overlap_m(const RigidObject& moving, const RigidObject& other);

/// Like above, out of each triangle of solid scenery, in the world.
double overlap_m(const RigidObject& moving, const geometry::TriangleMesh& scenery);

/// Like above, for the deepest node of a soft object. Nodes that a pin holds do not count.
double overlap_m(const SoftObject& soft, const RigidObject& fixed);

}  // namespace atrium::physics
