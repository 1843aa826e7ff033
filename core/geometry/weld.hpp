#pragma once

#include "core/geometry/triangle_mesh.hpp"

namespace atrium::geometry {

/// Merges vertices that are within about a micrometre and drops the triangles that this collapses.
/// Model files repeat vertices for different normals and texture coordinates. Keeps the order of
/// the first vertices. The indices of `mesh` must be valid.
TriangleMesh weld(const TriangleMesh& mesh);

}  // namespace atrium::geometry
