#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace atrium::refine {

/// An edge and the vertex that divides it.
struct SplitEdge {
    std::uint32_t low = 0;  // low < high
    std::uint32_t high = 0;
    std::uint32_t middle = 0;
};

/// Divides the triangles at `edges`, which are sorted by their ends and whose middles exist
/// already. A closed 2-manifold stays one, with the same components. Of the two ways to divide a
/// quadrilateral it takes the shorter diagonal. `labels` has one per triangle; parts inherit it.
void split_edges(std::span<const SplitEdge> edges,
                 geometry::TriangleMesh& mesh,
                 std::vector<std::int32_t>& labels);

}  // namespace atrium::refine
