#include "core/geometry/weld.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace atrium::geometry {

TriangleMesh weld(const TriangleMesh& mesh) {
    constexpr double kPerM = 1e6;
    const auto num_vertices = static_cast<std::uint32_t>(mesh.vertices.size());
    std::vector<Eigen::Vector3d> rounded;
    rounded.reserve(num_vertices);
    for (const Eigen::Vector3d& v : mesh.vertices) rounded.push_back((v * kPerM).array().round());
    std::vector<std::uint32_t> sorted(num_vertices);
    std::iota(sorted.begin(), sorted.end(), 0u);
    std::ranges::sort(sorted, [&](std::uint32_t a, std::uint32_t b) {
        const Eigen::Vector3d& p = rounded[a];
        const Eigen::Vector3d& q = rounded[b];
        return std::tuple(p.x(), p.y(), p.z(), a) < std::tuple(q.x(), q.y(), q.z(), b);
    });
    std::vector<std::uint32_t> first_at(num_vertices);  // per vertex the first one at its place
    for (std::uint32_t i = 0; i < num_vertices; ++i) {
        const bool is_new = i == 0 || rounded[sorted[i]] != rounded[sorted[i - 1]];
        first_at[sorted[i]] = is_new ? sorted[i] : first_at[sorted[i - 1]];
    }
    TriangleMesh welded;
    std::vector<std::uint32_t> new_index(num_vertices);
    for (std::uint32_t v = 0; v < num_vertices; ++v) {
        if (first_at[v] == v) {
            new_index[v] = static_cast<std::uint32_t>(welded.vertices.size());
            welded.vertices.push_back(mesh.vertices[v]);
        } else {
            new_index[v] = new_index[first_at[v]];
        }
    }
    for (const auto& triangle : mesh.triangles) {
        const std::array<std::uint32_t, 3> corners{
            new_index[triangle[0]], new_index[triangle[1]], new_index[triangle[2]]};
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            continue;
        welded.triangles.push_back(corners);
    }
    return welded;
}

}  // namespace atrium::geometry
