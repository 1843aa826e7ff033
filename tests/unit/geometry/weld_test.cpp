#include "core/geometry/weld.hpp"

#include <gtest/gtest.h>

namespace atrium::geometry {
namespace {

TEST(Weld, MergesVerticesAtOnePlaceInTheOrderOfTheFirst) {
    TriangleMesh mesh;
    mesh.vertices = {{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-0.0, 1e-9, 0}, {1, 0, 0}, {0, 0, 1e-3}};
    mesh.triangles = {{1, 0, 2}, {3, 4, 5}};
    const TriangleMesh welded = weld(mesh);
    ASSERT_EQ(welded.vertices.size(), 4u);
    EXPECT_EQ(welded.vertices[0], mesh.vertices[0]);
    EXPECT_EQ(welded.vertices[3], mesh.vertices[5]);
    ASSERT_EQ(welded.triangles.size(), 2u);
    EXPECT_EQ(welded.triangles[0], (std::array<std::uint32_t, 3>{1, 0, 2}));
    EXPECT_EQ(welded.triangles[1], (std::array<std::uint32_t, 3>{1, 0, 3}));
}

TEST(Weld, DropsTrianglesThatCollapse) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_TRUE(weld(mesh).triangles.empty());
    EXPECT_TRUE(weld({}).vertices.empty());
}

}  // namespace
}  // namespace atrium::geometry
