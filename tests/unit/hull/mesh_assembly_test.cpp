#include "site_node/hull/mesh_assembly.hpp"

#include "tests/support/allocation_counter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

namespace atrium::hull {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Faces as strips deliver them: each face in its own run. Each vertex is named in all of its faces,
// and the first of them places it.
class Faces {
public:
    /// `first_key` is the key of the first vertex. The keys of bodies must differ.
    void add(const std::vector<Eigen::Vector3d>& points,
             const std::vector<Triangle>& triangles,
             VertexKey first_key,
             bool may_be_needed) {
        std::set<std::uint32_t> placed;
        for (const Triangle& triangle : triangles) {
            RunFaces& face = runs.emplace_back();
            for (const std::uint32_t v : triangle) {
                const bool is_owner = placed.insert(v).second;
                face.vertices.push_back({first_key + v, is_owner, may_be_needed, points[v]});
            }
            face.triangles = {{0, 1, 2}};
            face.edges = {{0, 1}, {1, 2}, {2, 0}};
            face.num_sides_on_lines = 3;
        }
    }
    std::vector<RunFaces> runs;
};

const std::vector<Eigen::Vector3d> kTetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> kItsFaces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

class Assembly : public testing::Test {
protected:
    Assembly() {
        cones_.origin = {10.0, 0.0, 0.0};
        faces_.add(kTetrahedron, kItsFaces, 1, true);
    }
    bool assemble() {
        SerialExecutor executor;
        return assembly_.assemble(cones_, faces_.runs, {}, executor, hull_);
    }
    // Assembles after a mesh with a phantom, to find leftovers.
    void expect_refused(const std::vector<RunFaces>& broken) {
        faces_.add(kTetrahedron, kItsFaces, 100, false);
        ASSERT_TRUE(assemble());
        ASSERT_EQ(hull_.num_components + hull_.num_phantoms_dropped, 2u);
        for (const std::uint32_t min_seen : {0u, 1u}) {
            cones_.min_seen = min_seen;
            faces_.runs = broken;
            EXPECT_FALSE(assemble());
            EXPECT_TRUE(hull_.mesh.vertices.empty());
            EXPECT_TRUE(hull_.mesh.triangles.empty());
            EXPECT_EQ(hull_.num_components, 0u);
            EXPECT_EQ(hull_.num_phantoms_dropped, 0u);
            EXPECT_EQ(hull_.num_fragments_dropped, 0u);
            EXPECT_EQ(hull_.volume_dropped_m3, 0.0);
        }
    }
    Cones cones_;
    Faces faces_;
    MeshAssembly assembly_;
    VisualHull hull_;
};

TEST_F(Assembly, JoinsFacesByVertexKey) {
    ASSERT_TRUE(assemble());
    const geometry::MeshReport report = geometry::inspect(hull_.mesh);
    EXPECT_TRUE(report.manifold);
    EXPECT_NEAR(report.volume_m3, 1.0 / 6.0, 1e-12);
    EXPECT_EQ(hull_.mesh.vertices.size(), 4u);
    EXPECT_NEAR(geometry::bounds(hull_.mesh).max.x(), 11.0, 1e-12);
    EXPECT_EQ(hull_.num_components, 1u);
}

TEST_F(Assembly, DropsAndCountsPhantomsAndFragments) {
    faces_.add(kTetrahedron, kItsFaces, 100, false);
    std::vector<Eigen::Vector3d> small;
    for (const Eigen::Vector3d& p : kTetrahedron) small.emplace_back(0.01 * p);
    faces_.add(small, kItsFaces, 200, true);
    ASSERT_TRUE(assemble());
    EXPECT_EQ(hull_.num_components, 1u);
    EXPECT_EQ(hull_.num_phantoms_dropped, 1u);
    EXPECT_EQ(hull_.num_fragments_dropped, 1u);
    EXPECT_NEAR(hull_.volume_dropped_m3, (1.0 + 1e-6) / 6.0, 1e-12);
    EXPECT_EQ(hull_.mesh.vertices.size(), 4u);
}

TEST_F(Assembly, RefusesASurfaceWithAMissingFace) {
    Faces open;
    open.add(kTetrahedron, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}}, 1, true);
    expect_refused(open.runs);
}

TEST_F(Assembly, RefusesAFlippedFace) {
    Faces turned;
    turned.add(kTetrahedron, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 3, 2}}, 1, true);
    expect_refused(turned.runs);
}

TEST_F(Assembly, RefusesAVertexWithoutAPosition) {
    std::vector<RunFaces> unplaced = faces_.runs;
    unplaced[0].vertices[0].is_owner = false;
    expect_refused(unplaced);
}

TEST_F(Assembly, RefusesTwoFansAtOneVertex) {
    Faces touching;
    const std::vector<Triangle> both{
        {0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
    std::vector<Eigen::Vector3d> points = kTetrahedron;
    for (std::size_t i = 1; i < 4; ++i) points.emplace_back(-kTetrahedron[i]);
    touching.add(points, both, 1, true);
    expect_refused(touching.runs);
}

// If two faces have corners on one line of two strips, both could be cut along it.
TEST_F(Assembly, RefusesADiagonalOnALineOfTwoStrips) {
    ++faces_.runs[2].num_sides_on_lines;
    EXPECT_FALSE(assemble());
}

TEST_F(Assembly, AllowsMoreThanThreeFacesPerVertexOnlyWithCountedViews) {
    faces_.runs.clear();
    faces_.add(
        {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
        {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}},
        1,
        true);
    EXPECT_FALSE(assemble());
    cones_.min_seen = 3;
    ASSERT_TRUE(assemble());
    EXPECT_TRUE(geometry::inspect(hull_.mesh).manifold);
    EXPECT_NEAR(geometry::volume_m3(hull_.mesh), 4.0 / 3.0, 1e-12);
}

TEST_F(Assembly, AllocatesNothingOnceWarm) {
    for (const std::uint32_t min_seen : {0u, 1u}) {
        cones_.min_seen = min_seen;
        ASSERT_TRUE(assemble());
        const std::uint64_t before = test::num_allocations();
        ASSERT_TRUE(assemble());
        EXPECT_EQ(test::num_allocations() - before, 0u);
    }
}

}  // namespace
}  // namespace atrium::hull
