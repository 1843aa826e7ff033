#include "core/geometry/closed_mesh.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>

namespace atrium::geometry {

void ClosedMesh::list_edges(const TriangleMesh& mesh) {
    num_triangles_ = mesh.triangles.size();
    corner_.resize(3 * num_triangles_);
    twin_.resize(corner_.size());
    edge_at_.assign(mesh.vertices.size(), kNone);
    Edge e = 0;
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) {
            corner_[e] = v;
            // until its twin is found: link to another edge from the same vertex
            twin_[e] = edge_at_[v];
            edge_at_[v] = e++;
        }
    }
}

// Links the edges around `v`. The twin of an edge from `v` starts at the edge's other vertex; the
// edge after that twin is the next one from `v`. The edges form one fan if the first is reached
// again after all others.
bool ClosedMesh::link_fan(std::uint32_t v) {
    const Edge begin = edge_at_[v];
    std::uint32_t num_edges = 0;
    for (Edge e = begin; e != kNone; e = twin_[e]) {
        per_vertex_[from(previous(e))] = previous(e);
        ++num_edges;
    }
    Edge e = begin;
    for (; num_edges > 0; --num_edges) {
        const Edge twin = per_vertex_[to(e)];
        // no twin; the entry may be left over from another vertex
        if (twin == kNone || to(twin) != v) return false;
        twin_[e] = twin;
        e = next(twin);
        if (e == begin) break;
    }
    return num_edges == 1;
}

bool ClosedMesh::link_fans() {
    per_vertex_.assign(edge_at_.size(), kNone);
    for (std::uint32_t v = 0; v < edge_at_.size(); ++v) {
        if (!link_fan(v)) return false;
    }
    return true;
}

// Describes the first fault of a mesh that is not closed or not 2-manifold.
Expected<void> ClosedMesh::find_fault(const TriangleMesh& mesh) {
    EdgeGroups groups;
    if (auto grouped = groups.assign(mesh); !grouped) return grouped;
    Expected<void> result;
    std::fill(per_vertex_.begin(), per_vertex_.end(), 0U);
    groups.for_each([&](std::uint32_t smaller, std::span<const EdgeGroups::Entry> group) {
        if (EdgeGroups::is_pair(group)) {
            join(group[0].edge, group[1].edge);
            return true;
        }
        result = make_error(
            ErrorKind::kInvalidData,
            "mesh: not closed: the edge between vertices " + std::to_string(smaller) + " and " +
                std::to_string(group[0].larger) + " needs two triangles in opposite directions");
        return false;
    });
    if (!result) return result;
    for (const std::uint32_t v : corner_) ++per_vertex_[v];
    std::uint32_t v = 0;
    // turning around a vertex must reach all of its edges
    while (v + 1 < per_vertex_.size() && per_vertex_[v] != 0 &&
           degree(v, std::numeric_limits<std::uint32_t>::max()) == per_vertex_[v])
        ++v;
    return make_error(
        ErrorKind::kInvalidData,
        "mesh: not 2-manifold: vertex " + std::to_string(v) + " needs triangles that form one fan");
}

Expected<void> ClosedMesh::assign(const TriangleMesh& mesh) {
    if (auto checked = check_triangles(mesh); !checked) return checked;
    list_edges(mesh);
    mark_.assign(mesh.vertices.size(), 0);
    serial_ = 0;
    return link_fans() ? Expected<void>() : find_fault(mesh);
}

void ClosedMesh::join(Edge a, Edge b) {
    twin_[a] = b;
    twin_[b] = a;
}

std::uint32_t ClosedMesh::degree(std::uint32_t v, std::uint32_t limit) const {
    const Edge begin = edge_at_[v];
    std::uint32_t count = 0;
    Edge e = begin;
    do {
        ++count;
        e = turned(e);
    } while (e != begin && count < limit);
    return count;
}

bool ClosedMesh::can_collapse(Edge e, std::uint32_t max_degree) {
    ++serial_;
    std::uint32_t degree_from = 0;
    Edge spoke = e;
    do {
        mark_[to(spoke)] = serial_;
        spoke = turned(spoke);
        if (++degree_from >= max_degree) return false;
    } while (spoke != e);
    std::uint32_t degree_to = 0;
    std::uint32_t num_common = 0;
    spoke = twin(e);
    do {
        num_common += mark_[to(spoke)] == serial_ ? 1 : 0;
        spoke = turned(spoke);
        if (++degree_to >= max_degree) return false;
    } while (spoke != twin(e));
    // two triangles back to back and a tetrahedron cannot be reduced
    return num_common == 2 && degree_from > 2 && degree_to > 2 && degree_from + degree_to > 6;
}

void ClosedMesh::collapse(Edge e) {
    const Edge back = twin(e);
    const std::uint32_t gone = from(e);
    const std::uint32_t kept = to(e);
    const Edge left_inner = twin(previous(e));      // gone -> left corner
    const Edge left_outer = twin(next(e));          // left corner -> kept
    const Edge right_inner = twin(next(back));      // right corner -> gone
    const Edge right_outer = twin(previous(back));  // kept -> right corner
    for (Edge spoke = turned(e); spoke != e; spoke = turned(spoke)) corner_[spoke] = kept;
    join(left_inner, left_outer);
    join(right_inner, right_outer);
    edge_at_[from(left_outer)] = left_outer;
    edge_at_[from(right_inner)] = right_inner;
    edge_at_[kept] = left_inner;
    edge_at_[gone] = kNone;
    for (const Edge side : {e, back}) {
        for (const Edge dead : {side, next(side), previous(side)}) corner_[dead] = kNone;
    }
    num_triangles_ -= 2;
}

void ClosedMesh::extract(const std::vector<Eigen::Vector3d>& vertices, TriangleMesh& out) {
    assert(vertices.size() == edge_at_.size());
    out.clear();
    per_vertex_.resize(edge_at_.size());
    for (std::size_t v = 0; v < edge_at_.size(); ++v) {
        if (edge_at_[v] == kNone) continue;
        per_vertex_[v] = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(vertices[v]);
    }
    for (std::size_t e = 0; e < corner_.size(); e += 3) {
        if (corner_[e] == kNone) continue;
        out.triangles.push_back(
            {per_vertex_[corner_[e]], per_vertex_[corner_[e + 1]], per_vertex_[corner_[e + 2]]});
    }
}

}  // namespace atrium::geometry
