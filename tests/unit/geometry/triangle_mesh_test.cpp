#include "core/geometry/triangle_mesh.hpp"

#include "tests/support/shapes/box_mesh.hpp"
#include "tests/support/shapes/winding_number.hpp"

#include <gtest/gtest.h>

namespace atrium::geometry {
namespace {

using test::box_mesh;

TEST(InspectMesh, AcceptsABox) {
    const MeshReport report = inspect(box_mesh({1, 2, 3}, {0.5, 2, 1}));
    EXPECT_TRUE(report.closed);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.num_components, 1u);
    EXPECT_EQ(report.euler_characteristic, 2);
    EXPECT_NEAR(report.volume_m3, 1.0, 1e-12);
}

TEST(InspectMesh, CountsComponents) {
    TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    append(mesh, box_mesh({5, 0, 0}, {1, 1, 1}));
    const MeshReport report = inspect(mesh);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.num_components, 2u);
    EXPECT_EQ(report.euler_characteristic, 4);
}

TEST(InspectMesh, FindsHolesFlippedTrianglesAndUnusedVertices) {
    TriangleMesh open = box_mesh({0, 0, 0}, {1, 1, 1});
    open.triangles.pop_back();
    EXPECT_FALSE(inspect(open).closed);
    TriangleMesh flipped = box_mesh({0, 0, 0}, {1, 1, 1});
    std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
    EXPECT_FALSE(inspect(flipped).closed);
    TriangleMesh unused = box_mesh({0, 0, 0}, {1, 1, 1});
    unused.vertices.push_back({9, 9, 9});
    EXPECT_TRUE(inspect(unused).closed);
    EXPECT_FALSE(inspect(unused).manifold);
}

TEST(InspectMesh, FindsTwoFansAtOneVertex) {
    TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    append(mesh, box_mesh({1, 1, 1}, {1, 1, 1}));
    for (auto& t : mesh.triangles) {
        for (auto& v : t)
            v = v == 8 ? 7 : (v > 8 ? v - 1 : v);  // vertex 8 is the corner that touches vertex 7
    }
    mesh.vertices.erase(mesh.vertices.begin() + 8);
    EXPECT_TRUE(inspect(mesh).closed);
    EXPECT_FALSE(inspect(mesh).manifold);
}

TEST(InspectMesh, SurvivesIndicesOutOfRange) {
    TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    mesh.triangles[3][1] = 99;
    const MeshReport report = inspect(mesh);
    EXPECT_FALSE(report.closed);
    EXPECT_FALSE(report.manifold);
}

TEST(WindingNumber, IsOneInsideAndZeroOutside) {
    const TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
    EXPECT_NEAR(test::winding_number(mesh, {0.3, 0.4, 0.9}), 1.0, 1e-9);
    EXPECT_NEAR(test::winding_number(mesh, {1.3, 0.4, 0.9}), 0.0, 1e-9);
}

TEST(VertexNormals, PointOutOfABox) {
    const TriangleMesh mesh = box_mesh({-1, -1, -1}, {2, 2, 2});
    const auto normals = vertex_normals(mesh);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        EXPECT_NEAR(normals[i].norm(), 1.0f, 1e-6f);
        EXPECT_GT(normals[i].dot(mesh.vertices[i].cast<float>()), 1.0f);
    }
}

// A box corner has three faces with equal angles, however the faces are triangulated and however
// long the edges are.
TEST(VertexNormals, DoNotDependOnTheTriangulation) {
    const TriangleMesh mesh = box_mesh({-1, -2, -3}, {2, 4, 6});
    const auto normals = vertex_normals(mesh);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Eigen::Vector3d diagonal = mesh.vertices[i].cwiseSign().normalized();
        EXPECT_LT((normals[i] - diagonal.cast<float>()).norm(), 1e-6f);
    }
}

TEST(VertexNormals, IgnoreTrianglesThatAreMereRounding) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0.5, 0, 1.0 - 1e-15}, {5, 5, 5}};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
    const auto normals = vertex_normals(mesh);
    for (const std::size_t v : {0u, 1u, 2u})
        EXPECT_LT((normals[v] - Eigen::Vector3f::UnitZ()).norm(), 1e-6f);
    EXPECT_TRUE(normals[3].isZero());
    EXPECT_TRUE(normals[4].isZero());
}

}  // namespace
}  // namespace atrium::geometry
