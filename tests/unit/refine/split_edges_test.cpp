#include "site_node/refine/split_edges.hpp"

#include "tests/support/random.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::refine {
namespace {

geometry::TriangleMesh tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

std::vector<SplitEdge> edges_of(const geometry::TriangleMesh& mesh) {
    std::vector<SplitEdge> edges;
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = triangle[k];
            const std::uint32_t b = triangle[(k + 1) % 3];
            if (a < b) edges.push_back({a, b, 0});
        }
    }
    std::ranges::sort(edges, [](const SplitEdge& a, const SplitEdge& b) {
        return a.low != b.low ? a.low < b.low : a.high < b.high;
    });
    return edges;
}

// Area of the triangles with this label.
double area(const geometry::TriangleMesh& mesh,
            const std::vector<std::int32_t>& labels,
            std::int32_t label) {
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (labels[t] != label) continue;
        const auto& [a, b, c] = mesh.triangles[t];
        const Eigen::Vector3d along = mesh.vertices[b] - mesh.vertices[a];
        sum += 0.5 * along.cross(mesh.vertices[c] - mesh.vertices[a]).norm();
    }
    return sum;
}

TEST(SplitEdges, KeepTheSurfaceForAnyChoiceOfEdges) {
    test::Random random(11);
    for (int trial = 0; trial < 200; ++trial) {
        geometry::TriangleMesh mesh = tetrahedron();
        std::vector<std::int32_t> labels{0, 1, 2, 3};
        const std::vector<std::int32_t> faces = labels;
        for (int pass = 0; pass < 4; ++pass) {
            std::vector<SplitEdge> chosen;
            const std::size_t num_edges = edges_of(mesh).size();
            const double share = test::between(random, 0.0, 1.0);
            for (SplitEdge edge : edges_of(mesh)) {
                if (test::between(random, 0.0, 1.0) > share) continue;
                edge.middle = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.emplace_back(0.5 *
                                           (mesh.vertices[edge.low] + mesh.vertices[edge.high]));
                chosen.push_back(edge);
            }
            const std::size_t num_triangles = mesh.triangles.size();
            split_edges(chosen, mesh, labels);
            const geometry::MeshReport report = geometry::inspect(mesh);
            ASSERT_TRUE(report.manifold);
            ASSERT_EQ(report.num_components, 1U);
            ASSERT_EQ(report.euler_characteristic, 2);
            ASSERT_NEAR(report.volume_m3, 1.0 / 6.0, 1e-12);
            // each divided edge adds a triangle on both sides
            ASSERT_EQ(mesh.triangles.size(), num_triangles + 2 * chosen.size());
            ASSERT_LE(chosen.size(), num_edges);
            ASSERT_EQ(labels.size(), mesh.triangles.size());
            for (const std::int32_t face : faces) {
                ASSERT_NEAR(area(mesh, labels, face), area(tetrahedron(), faces, face), 1e-12);
            }
        }
    }
}

TEST(SplitEdges, TakesTheShorterDiagonal) {
    // two edges that meet in the far tip are divided: the quadrilateral at the base is left
    geometry::TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {-0.5, 0.5, 0}, {0, 0.5, 0}},
                                {{0, 1, 2}}};
    const std::vector<SplitEdge> edges{{0, 2, 3}, {1, 2, 4}};
    std::vector<std::int32_t> labels{7};
    split_edges(edges, mesh, labels);
    EXPECT_EQ(labels, (std::vector<std::int32_t>{7, 7, 7}));
    ASSERT_EQ(mesh.triangles.size(), 3U);
    const auto has = [&](std::uint32_t a, std::uint32_t b) {
        return std::ranges::any_of(mesh.triangles, [&](const auto& t) {
            return std::ranges::count(t, a) == 1 && std::ranges::count(t, b) == 1;
        });
    };
    EXPECT_TRUE(has(0, 4));
    EXPECT_FALSE(has(1, 3));
}

}  // namespace
}  // namespace atrium::refine
