#include "core/geometry/closed_mesh.hpp"

#include "tests/support/random.hpp"
#include "tests/support/shapes/closed_meshes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace atrium::geometry {
namespace {

using test::Random;
using ::testing::HasSubstr;

/// By the definition: each triangle has three different vertices. Each edge has exactly one partner
/// in the opposite direction. The corners of a vertex are connected through its edges.
bool is_closed_2_manifold(const TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> ends;  // edge to third vertex
    for (const auto& [a, b, c] : mesh.triangles) {
        if (a == b || b == c || c == a) return false;
        if (!ends.try_emplace({a, b}, c).second || !ends.try_emplace({b, c}, a).second ||
            !ends.try_emplace({c, a}, b).second)
            return false;
    }
    std::map<std::uint32_t, std::set<std::uint32_t>> neighbours;
    for (const auto& [edge, end] : ends) {
        if (!ends.contains({edge.second, edge.first})) return false;
        neighbours[edge.first].insert(edge.second);
    }
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
        if (!neighbours.contains(v)) return false;
        const std::uint32_t first = *neighbours[v].begin();
        std::size_t num_met = 0;
        std::uint32_t neighbour = first;
        do {
            neighbour = ends.at({v, neighbour});
            ++num_met;
        } while (neighbour != first);
        if (num_met != neighbours[v].size()) return false;
    }
    return true;
}

void expect_neighbours(const ClosedMesh& surface, const TriangleMesh& mesh) {
    ASSERT_EQ(surface.num_triangles(), mesh.triangles.size());
    for (ClosedMesh::Edge e = 0; e < 3 * mesh.triangles.size(); ++e) {
        EXPECT_EQ(surface.from(e), mesh.triangles[e / 3][e % 3]);
        EXPECT_EQ(surface.to(e), mesh.triangles[e / 3][(e + 1) % 3]);
        EXPECT_EQ(surface.twin(surface.twin(e)), e);
        EXPECT_EQ(surface.from(surface.twin(e)), surface.to(e));
        EXPECT_EQ(surface.to(surface.twin(e)), surface.from(e));
        EXPECT_NE(surface.twin(e), e);
    }
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
        EXPECT_EQ(surface.from(surface.edge_at(v)), v);
}

TEST(ClosedMesh, AcceptsOnlyClosed2Manifolds) {
    Random random(41);
    ClosedMesh surface;  // shared by all meshes, to find leftovers of the previous mesh
    int num_taken = 0;
    constexpr int kRounds = 3000;
    for (int round = 0; round < kRounds; ++round) {
        TriangleMesh mesh = test::make_octahedron({0, 0, 0}, 1.0);
        if (round % 2 == 0) geometry::append(mesh, test::make_torus(4, 3));
        if (round % 3 == 0) geometry::append(mesh, test::make_octahedron({1, 0, 0}, 1.0));
        for (int damage = test::between(random, 0, 2); damage > 0; --damage)
            mesh.triangles[random() % mesh.triangles.size()][random() % 3] =
                static_cast<std::uint32_t>(random() % mesh.vertices.size());
        if (round % 5 == 0) {
            // merging two vertices can leave one unused or create two fans
            const auto from = static_cast<std::uint32_t>(random() % mesh.vertices.size());
            const auto to = static_cast<std::uint32_t>(random() % mesh.vertices.size());
            for (auto& triangle : mesh.triangles)
                std::replace(triangle.begin(), triangle.end(), from, to);
            if (round % 2 == 0 && from + 1 == mesh.vertices.size()) mesh.vertices.pop_back();
        }
        std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
        const bool is_taken = surface.assign(mesh).has_value();
        ASSERT_EQ(is_taken, is_closed_2_manifold(mesh)) << "round " << round;
        if (is_taken) expect_neighbours(surface, mesh);
        num_taken += is_taken ? 1 : 0;
    }
    EXPECT_GT(num_taken, kRounds / 5);
    EXPECT_LT(num_taken, kRounds / 2);
}

TEST(ClosedMesh, NamesTheDefectAndItsPlace) {
    const TriangleMesh good = test::make_torus(5, 4);
    ClosedMesh surface;
    ASSERT_TRUE(surface.assign(good));
    TriangleMesh bad = good;
    bad.triangles.pop_back();
    EXPECT_THAT(surface.assign(bad).error().message, HasSubstr("the edge between vertices"));
    bad = good;
    bad.triangles[7] = {1, 1, 2};
    EXPECT_THAT(surface.assign(bad).error().message, HasSubstr("triangle 7 "));
    bad = good;
    bad.triangles[8][2] = 20;
    EXPECT_THAT(surface.assign(bad).error().message, HasSubstr("triangle 8 "));
    bad = good;
    bad.vertices.emplace_back(0, 0, 0);
    EXPECT_THAT(surface.assign(bad).error().message, HasSubstr("vertex 20 "));
    bad = good;
    geometry::append(bad, good);
    bad.vertices.pop_back();
    for (auto& triangle : bad.triangles) std::replace(triangle.begin(), triangle.end(), 39U, 6U);
    EXPECT_THAT(surface.assign(bad).error().message, HasSubstr("vertex 6 "));
    ASSERT_TRUE(surface.assign(good));
    expect_neighbours(surface, good);
}

}  // namespace
}  // namespace atrium::geometry
