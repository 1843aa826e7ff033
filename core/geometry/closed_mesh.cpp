#include "core/geometry/closed_mesh.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>

namespace atrium::geometry {

Expected<void> ClosedMesh::assign(const TriangleMesh& mesh) {
    if (auto checked = check_indices(mesh); !checked) return checked;
    num_triangles_ = mesh.triangles.size();
    corner_.resize(3 * num_triangles_);
    edge_at_.assign(mesh.vertices.size(), kNone);
    for (Edge e = 0; e < corner_.size(); ++e) {
        corner_[e] = mesh.triangles[e / 3][e % 3];
        edge_at_[corner_[e]] = e;
    }
    mark_.assign(mesh.vertices.size(), 0);
    serial_ = 0;
    if (auto found = find_twins(); !found) return found;
    return check_fans();
}

Expected<void> ClosedMesh::check_indices(const TriangleMesh& mesh) const {
    if (mesh.triangles.size() >= kNone / 3 || mesh.vertices.size() >= kNone)
        return make_error(ErrorKind::kInvalidData, "mesh: more than 1.4 G triangles");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        if (std::max({a, b, c}) < mesh.vertices.size() && a != b && b != c && c != a) continue;
        return make_error(ErrorKind::kInvalidData,
                          "mesh: triangle " + std::to_string(t) +
                              " needs three different vertices below " +
                              std::to_string(mesh.vertices.size()));
    }
    return {};
}

// Edges between the same two vertices meet in the list of the smaller one.
Expected<void> ClosedMesh::find_twins() {
    const auto num_edges = static_cast<Edge>(corner_.size());
    first_.assign(edge_at_.size() + 1, 0);
    for (Edge e = 0; e < num_edges; ++e) ++first_[std::min(from(e), to(e)) + 1];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    by_smaller_.resize(num_edges);
    for (Edge e = 0; e < num_edges; ++e)
        by_smaller_[first_[std::min(from(e), to(e))]++] = {std::max(from(e), to(e)), e};
    twin_.resize(num_edges);
    std::uint32_t begin = 0;
    for (std::size_t v = 0; v < edge_at_.size(); ++v) {
        const std::uint32_t end = first_[v];  // moved on while the list was filled
        std::sort(by_smaller_.begin() + begin, by_smaller_.begin() + end);
        for (std::uint32_t i = begin; i < end; i += 2) {
            const auto [other, e] = by_smaller_[i];
            const bool is_pair = i + 1 < end && by_smaller_[i + 1].first == other &&
                                 from(by_smaller_[i + 1].second) != from(e);
            const bool has_third = i + 2 < end && by_smaller_[i + 2].first == other;
            if (!is_pair || has_third) {
                return make_error(ErrorKind::kInvalidData,
                                  "mesh: not closed: the edge between vertices " +
                                      std::to_string(v) + " and " + std::to_string(other) +
                                      " needs two triangles in opposite directions");
            }
            join(e, by_smaller_[i + 1].second);
        }
        begin = end;
    }
    return {};
}

// All edges from a vertex are met by turning around it.
Expected<void> ClosedMesh::check_fans() {
    first_.assign(edge_at_.size(), 0);
    for (const std::uint32_t v : corner_) ++first_[v];
    for (std::uint32_t v = 0; v < edge_at_.size(); ++v) {
        if (first_[v] != 0 && degree(v, std::numeric_limits<std::uint32_t>::max()) == first_[v])
            continue;
        return make_error(ErrorKind::kInvalidData,
                          "mesh: not 2-manifold: vertex " + std::to_string(v) +
                              " needs triangles that form one fan");
    }
    return {};
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
    // two triangles back to back, or a tetrahedron, have nothing to give
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
    first_.resize(edge_at_.size());
    for (std::size_t v = 0; v < edge_at_.size(); ++v) {
        if (edge_at_[v] == kNone) continue;
        first_[v] = static_cast<std::uint32_t>(out.vertices.size());
        out.vertices.push_back(vertices[v]);
    }
    for (std::size_t e = 0; e < corner_.size(); e += 3) {
        if (corner_[e] == kNone) continue;
        out.triangles.push_back(
            {first_[corner_[e]], first_[corner_[e + 1]], first_[corner_[e + 2]]});
    }
}

}  // namespace atrium::geometry
