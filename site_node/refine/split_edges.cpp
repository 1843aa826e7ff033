#include "site_node/refine/split_edges.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace atrium::refine {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

std::optional<std::uint32_t> middle_of(std::uint32_t a,
                                       std::uint32_t b,
                                       std::span<const SplitEdge> edges) {
    const auto [low, high] = std::minmax(a, b);
    const auto before = [](const SplitEdge& edge,
                           const std::pair<std::uint32_t, std::uint32_t>& ends) {
        return std::pair(edge.low, edge.high) < ends;
    };
    const auto found = std::lower_bound(edges.begin(), edges.end(), std::pair(low, high), before);
    if (found == edges.end() || found->low != low || found->high != high) return std::nullopt;
    return found->middle;
}

}  // namespace

void split_edges(std::span<const SplitEdge> edges, geometry::TriangleMesh& mesh) {
    if (edges.empty()) return;
    const auto length_sq = [&](std::uint32_t a, std::uint32_t b) {
        return (mesh.vertices[a] - mesh.vertices[b]).squaredNorm();
    };
    const std::size_t num_before = mesh.triangles.size();
    for (std::size_t i = 0; i < num_before; ++i) {
        const Triangle t = mesh.triangles[i];
        std::array<std::optional<std::uint32_t>, 3>
            middles;  // of the edge from corner k to the next
        std::size_t num = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            middles[k] = middle_of(t[k], t[(k + 1) % 3], edges);
            num += middles[k] ? 1 : 0;
        }
        if (num == 0) continue;
        std::vector<Triangle>& triangles = mesh.triangles;
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
