#pragma once

#include "core/geometry/triangle_mesh.hpp"

namespace atrium::geometry {

/// Returns the parts of `mesh` that are solid bodies: connected closed surfaces that face outwards,
/// with the hollows in them. Vertices at one place count as one.
///
/// Left out is what things may stand in: open surfaces (a terrain, a bowl of one sheet), surfaces
/// that face inwards (a room), and those that are at least `room_m` large along each axis (a room
/// that was modelled from outside). The indices of `mesh` must be valid.
TriangleMesh solid_parts(const TriangleMesh& mesh, double room_m);

}  // namespace atrium::geometry
