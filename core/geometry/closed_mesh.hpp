#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/edge_groups.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <cstdint>
#include <vector>

namespace atrium::geometry {

/// Which triangles of a closed 2-manifold are neighbours, while edges collapse. Knows no positions.
///
/// An edge is directed and belongs to one triangle, which lies to its left: 3 * triangle + the
/// place of its first corner. Reuse one object; it allocates only while it grows.
class ClosedMesh {
public:
    using Edge = std::uint32_t;
    static constexpr std::uint32_t kNone = 0xffffffffu;

    /// kInvalidData, naming a place, unless `mesh` is closed and 2-manifold (as `inspect` says).
    Expected<void> assign(const TriangleMesh& mesh);

    std::size_t num_triangles() const { return num_triangles_; }

    static std::uint32_t triangle_of(Edge e) { return e / 3; }
    // without branches, which could not be foretold
    static Edge next(Edge e) { return e + 1 - 3 * static_cast<Edge>(e % 3 == 2); }
    static Edge previous(Edge e) { return e - 1 + 3 * static_cast<Edge>(e % 3 == 0); }
    Edge twin(Edge e) const { return twin_[e]; }
    std::uint32_t from(Edge e) const { return corner_[e]; }
    std::uint32_t to(Edge e) const { return corner_[next(e)]; }
    /// The next edge from the same vertex, counter-clockwise.
    Edge turned(Edge e) const { return twin_[previous(e)]; }
    /// One of the edges from vertex `v`; kNone where it is gone.
    Edge edge_at(std::uint32_t v) const { return edge_at_[v]; }
    bool has_triangle(std::uint32_t t) const { return corner_[3 * std::size_t{t}] != kNone; }

    /// Number of edges from `v`, or `limit` where there are at least that many.
    std::uint32_t degree(std::uint32_t v, std::uint32_t limit) const;

    /// The link condition: whether letting from(e) move into to(e) leaves the surface a 2-manifold
    /// of the same topology. False as well where one of them has `max_degree` or more edges.
    bool can_collapse(Edge e, std::uint32_t max_degree);

    /// Lets from(e) become to(e); the triangles on both sides of `e` vanish. The others keep their
    /// numbers and edges. Only where `can_collapse`.
    void collapse(Edge e);

    /// What is left, with vertices and triangles in their former order.
    void extract(const std::vector<Eigen::Vector3d>& vertices, TriangleMesh& out);

private:
    void list_edges(const TriangleMesh& mesh);
    bool link_fans();
    bool link_fan(std::uint32_t v);
    Expected<void> find_fault(const TriangleMesh& mesh);
    void join(Edge a, Edge b);

    std::size_t num_triangles_ = 0;
    std::vector<std::uint32_t> corner_;  // per edge its first vertex; kNone: the triangle is gone
    std::vector<Edge> twin_;             // per edge
    std::vector<Edge> edge_at_;          // per vertex
    std::vector<std::uint32_t> mark_;    // per vertex, the last `serial_` that met it
    std::uint32_t serial_ = 0;
    std::vector<std::uint32_t> per_vertex_;  // an edge from it, or its new number
};

}  // namespace atrium::geometry
