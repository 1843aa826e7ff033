#pragma once

#include "core/bus/messages.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

/// What the physics takes people and models for, in the words of the bus.
namespace atrium::world_server {

/// Fills all of `proxy`, whose memory is used again, as is that of `places`. Of more surfels than a
/// message takes every n-th counts; they are ordered by place, so that these are spread evenly.
void fill_proxy(const physics::PersonNow& person,
                std::vector<Eigen::Vector3f>& places,
                bus::PersonProxy& proxy);

/// The edges of convex parts in the object's frame, without those between triangles of one plane.
/// Parts beyond what a message takes are left out.
bus::ObjectProxy make_object_proxy(std::uint32_t object,
                                   const std::vector<geometry::TriangleMesh>& parts);

}  // namespace atrium::world_server
