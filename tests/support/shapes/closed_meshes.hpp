#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

// Meshes of known topology.
namespace atrium::test {

/// A tube around a circle, closed in both directions, with 2 * rings * sides triangles.
inline geometry::TriangleMesh make_torus(std::uint32_t rings,
                                         std::uint32_t sides,
                                         double tube_m = 0.3) {
    geometry::TriangleMesh mesh;
    for (std::uint32_t i = 0; i < rings; ++i) {
        for (std::uint32_t j = 0; j < sides; ++j) {
            const double around = 2.0 * std::numbers::pi * i / rings;
            const double across = 2.0 * std::numbers::pi * j / sides;
            const double radius_m = 0.7 + tube_m * std::cos(across);
            mesh.vertices.emplace_back(radius_m * std::cos(around),
                                       radius_m * std::sin(around),
                                       tube_m * std::sin(across));
            const std::uint32_t next_i = (i + 1) % rings * sides;
            const std::uint32_t next_j = (j + 1) % sides;
            mesh.triangles.push_back({i * sides + j, next_i + j, next_i + next_j});
            mesh.triangles.push_back({i * sides + j, next_i + next_j, i * sides + next_j});
        }
    }
    return mesh;
}

inline geometry::TriangleMesh make_octahedron(const Eigen::Vector3d& centre, double radius_m) {
    geometry::TriangleMesh mesh;
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)}) {
        mesh.vertices.push_back(centre + radius_m * axis);
        mesh.vertices.push_back(centre - radius_m * axis);
    }
    mesh.triangles = {
        {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return mesh;
}

/// Splits each triangle into four, `times` times. New vertices are on the sphere around the origin.
inline geometry::TriangleMesh make_sphere(int times, double radius_m) {
    geometry::TriangleMesh mesh = make_octahedron(Eigen::Vector3d::Zero(), radius_m);
    for (; times > 0; --times) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [found, is_new] =
                middles.try_emplace(std::minmax(a, b), mesh.vertices.size());
            if (is_new)
                mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized() *
                                        radius_m);
            return found->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b);
            const std::uint32_t bc = middle(b, c);
            const std::uint32_t ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    return mesh;
}

}  // namespace atrium::test
