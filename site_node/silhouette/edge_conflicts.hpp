#pragma once

#include "site_node/silhouette/silhouette_polygon.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::silhouette {

/// An edge, from vertex `edge` to the next, that meets another edge.
struct EdgeConflict {
    std::uint32_t polygon = 0;
    std::uint32_t edge = 0;
};

/// Reusable memory of find_conflicts.
struct EdgeGrid {
    struct Entry {
        std::uint32_t polygon;
        std::uint32_t edge;
        std::int32_t next;  // index of the next entry in the same cell; -1: none
    };
    std::vector<std::int32_t> cells;
    std::vector<Entry> entries;
};

/// Finds all edges that cross, touch or overlap another edge of any polygon, except at a shared
/// vertex, and edges without length. Each conflict lists both edges; an edge may be listed several
/// times. An empty result means that every polygon is simple and no two polygons meet. Expected
/// time O(edges) by a uniform grid.
void find_conflicts(std::span<const SilhouettePolygon> polygons,
                    EdgeGrid& grid,
                    std::vector<EdgeConflict>& out);

}  // namespace atrium::silhouette
