#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/edge_groups.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstdint>
#include <vector>

namespace atrium::geometry {

/// Holds the connectivity of a closed 2-manifold mesh and collapses its edges. Does not use
/// positions.
///
/// An edge is a directed half-edge of the triangle to its left: 3 * triangle + the position of its
/// first corner. Reuse one object: it allocates only while it grows.
class ClosedMesh {
public:
    using Edge = std::uint32_t;
    static constexpr std::uint32_t kNone = 0xffffffffu;

    /// Takes the triangles of `mesh`. Fails with kInvalidData, naming a triangle, edge or vertex,
    /// unless `mesh` is closed and 2-manifold (see `inspect`).
    Expected<void> assign(const TriangleMesh& mesh);

    std::size_t num_triangles() const { return num_triangles_; }

    static std::uint32_t triangle_of(Edge e) { return e / 3; }
    // branchless: a branch would be unpredictable
    static Edge next(Edge e) { return e + 1 - 3 * static_cast<Edge>(e % 3 == 2); }
    static Edge previous(Edge e) { return e - 1 + 3 * static_cast<Edge>(e % 3 == 0); }
    Edge twin(Edge e) const { return twin_[e]; }
    std::uint32_t from(Edge e) const { return corner_[e]; }
    std::uint32_t to(Edge e) const { return corner_[next(e)]; }
    /// The next edge from the same vertex, counter-clockwise.
    Edge turned(Edge e) const { return twin_[previous(e)]; }
    /// One of the edges from vertex `v`; kNone if the vertex was removed.
    Edge edge_at(std::uint32_t v) const { return edge_at_[v]; }
    bool has_triangle(std::uint32_t t) const { return corner_[3 * std::size_t{t}] != kNone; }

    /// Returns the number of edges from `v`, but at most `limit`.
    std::uint32_t degree(std::uint32_t v, std::uint32_t limit) const;

    /// Tests the link condition: true if merging from(e) into to(e) keeps a 2-manifold of the same
    /// topology. Also false if one of the two has `max_degree` or more edges.
    bool can_collapse(Edge e, std::uint32_t max_degree);

    /// Merges from(e) into to(e) and removes the triangles on both sides of `e`. The others keep
    /// their numbers and edges. Requires `can_collapse`.
    void collapse(Edge e);

    /// Writes the remaining vertices and triangles to `out`, in their original order.
    void extract(const std::vector<Eigen::Vector3d>& vertices, TriangleMesh& out);

private:
    void list_edges(const TriangleMesh& mesh);
    bool link_fans();
    bool link_fan(std::uint32_t v);
    Expected<void> find_fault(const TriangleMesh& mesh);
    void join(Edge a, Edge b);

    std::size_t num_triangles_ = 0;
    std::vector<std::uint32_t> corner_;  // per edge its first vertex; kNone: triangle removed
    std::vector<Edge> twin_;             // per edge
    std::vector<Edge> edge_at_;          // per vertex
    std::vector<std::uint32_t> mark_;    // per vertex, `serial_` of its last visit
    std::uint32_t serial_ = 0;
    std::vector<std::uint32_t> per_vertex_;  // scratch: an edge, a count or its new number
};

}  // namespace atrium::geometry
