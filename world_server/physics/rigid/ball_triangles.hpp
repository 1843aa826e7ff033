#pragma once

#include "world_server/physics/rigid/mesh_touches.hpp"

#include <vector>

namespace atrium::physics {

/// Leaves the triangles of a mesh that a ball may touch within `reach_m`. A ball that lies on a
/// face does not touch the edges in the plane of this face: they would stop it or make it jump.
/// `centre` is in the mesh's frame.
void leave_touched_by_ball(std::vector<MeshTriangle>& triangles,
                           const btVector3& centre,
                           btScalar radius_m,
                           btScalar reach_m,
                           const FlatContactOptions& options);

}  // namespace atrium::physics
