#pragma once

#include "core/bus/messages.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

/// Converts the collision shapes of people and models to bus messages (proxies).
namespace atrium::world_server {

/// Fills `proxy`. Reuses its memory and that of `places`. If there are more surfels than a message
/// holds, takes every n-th. Surfels are ordered by place, hence the selection is evenly spread.
void fill_proxy(const physics::PersonSnapshot& person,
                std::vector<Eigen::Vector3f>& places,
                bus::PersonProxy& proxy);

/// Returns the edges of convex parts in the object's frame, without edges between coplanar
/// triangles. Leaves out parts that exceed the message's limits.
bus::ObjectProxy make_object_proxy(std::uint32_t object,
                                   const std::vector<geometry::TriangleMesh>& parts);

}  // namespace atrium::world_server
