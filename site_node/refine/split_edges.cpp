#include "site_node/refine/split_edges.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <optional>
#include <vector>

namespace atrium::refine {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Finds the middles of edges.
class Middles {
public:
    Middles(std::span<const SplitEdge> edges, std::size_t num_vertices)
        : edges_(edges), begins_(num_vertices + 1, 0) {
        for (const SplitEdge& edge : edges) ++begins_[edge.low + 1];
        for (std::size_t v = 0; v < num_vertices; ++v) begins_[v + 1] += begins_[v];
    }

    std::optional<std::uint32_t> of(std::uint32_t a, std::uint32_t b) const {
        const auto [low, high] = std::minmax(a, b);
        for (std::uint32_t i = begins_[low]; i < begins_[low + 1]; ++i)
            if (edges_[i].high == high) return edges_[i].middle;
        return std::nullopt;
    }

private:
    std::span<const SplitEdge> edges_;
    std::vector<std::uint32_t> begins_;  // per vertex: its first edge as the lower end; one more
};

}  // namespace

void split_edges(std::span<const SplitEdge> edges,
                 geometry::TriangleMesh& mesh,
                 std::vector<std::int32_t>& labels) {
    assert(labels.size() == mesh.triangles.size());
    if (edges.empty()) return;
    const auto length_sq = [&](std::uint32_t a, std::uint32_t b) {
        return (mesh.vertices[a] - mesh.vertices[b]).squaredNorm();
    };
    const Middles all(edges, mesh.vertices.size());
    const std::size_t num_before = mesh.triangles.size();
    for (std::size_t i = 0; i < num_before; ++i) {
        const Triangle t = mesh.triangles[i];
        std::array<std::optional<std::uint32_t>, 3>
            middles;  // of the edge from corner k to the next
        std::size_t num = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            middles[k] = all.of(t[k], t[(k + 1) % 3]);
            num += middles[k] ? 1 : 0;
        }
        if (num == 0) continue;
        std::vector<Triangle>& triangles = mesh.triangles;
        const std::int32_t label = labels[i];
        labels.insert(labels.end(), num, label);  // each middle adds a triangle
        if (num == 3) {
            triangles[i] = {*middles[0], *middles[1], *middles[2]};
            for (std::size_t k = 0; k < 3; ++k)
                triangles.push_back({t[k], *middles[k], *middles[(k + 2) % 3]});
            continue;
        }
        std::size_t k = 0;
        if (num == 1) {  // the edge from a to b is divided
            while (!middles[k]) ++k;
            const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
            triangles[i] = {a, *middles[k], c};
            triangles.push_back({*middles[k], b, c});
            continue;
        }
        while (middles[k]) ++k;  // the edge from a to b is the only whole one
        const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
        const std::uint32_t bc = *middles[(k + 1) % 3], ca = *middles[(k + 2) % 3];
        triangles[i] = {ca, bc, c};
        if (length_sq(a, bc) < length_sq(b, ca)) {
            triangles.push_back({a, b, bc});
            triangles.push_back({a, bc, ca});
        } else {
            triangles.push_back({a, b, ca});
            triangles.push_back({b, bc, ca});
        }
    }
}

}  // namespace atrium::refine
