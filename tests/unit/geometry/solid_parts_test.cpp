#include "core/geometry/solid_parts.hpp"

#include "tests/support/shapes/closed_meshes.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace atrium::geometry {
namespace {

constexpr double kRoom_m = 1.8;

TriangleMesh ball(const Eigen::Vector3d& centre, double radius_m) {
    return test::make_octahedron(centre, radius_m);
}

TriangleMesh inwards(TriangleMesh mesh) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
    return mesh;
}

TriangleMesh both(TriangleMesh mesh, const TriangleMesh& more) {
    geometry::append(mesh, more);
    return mesh;
}

std::size_t num_solid(const TriangleMesh& mesh) {
    return solid_parts(mesh, kRoom_m).triangles.size();
}

TEST(SolidParts, KeepClosedSurfacesThatFaceOutwards) {
    const TriangleMesh one = ball({1, 2, 3}, 0.5);
    EXPECT_EQ(num_solid(one), 8u);
    EXPECT_EQ(num_solid(inwards(one)), 0u);
    TriangleMesh open = one;
    open.triangles.pop_back();
    EXPECT_EQ(num_solid(open), 0u);
    EXPECT_EQ(num_solid(both(open, ball({5, 0, 0}, 0.5))), 8u) << "each part by itself";
    EXPECT_EQ(num_solid(both(one, inwards(one))), 0u) << "a sheet with two sides";
    EXPECT_EQ(num_solid({}), 0u);
}

TEST(SolidParts, JoinRepeatedVertices) {
    const TriangleMesh one = ball({0, 0, 0}, 0.5);
    TriangleMesh loose;
    for (const auto& triangle : one.triangles) {
        const auto first = static_cast<std::uint32_t>(loose.vertices.size());
        for (const std::uint32_t v : triangle) loose.vertices.push_back(one.vertices[v]);
        loose.triangles.push_back({first, first + 1, first + 2});
    }
    EXPECT_EQ(num_solid(loose), 8u);
}

TEST(SolidParts, LeaveOutWhatIsAsLargeAsARoom) {
    EXPECT_EQ(num_solid(ball({0, 0, 0}, 0.9)), 0u);
    TriangleMesh low = ball({0, 0, 0}, 5.0);
    for (Eigen::Vector3d& v : low.vertices) v.z() *= 0.1;
    EXPECT_EQ(num_solid(low), 8u) << "1 m high";
}

TEST(SolidParts, KeepTheHollowsOfBodiesOnly) {
    const TriangleMesh hollow = inwards(ball({0, 0, 0}, 0.4));
    EXPECT_EQ(num_solid(both(ball({0, 0, 0}, 0.5), hollow)), 16u);
    const TriangleMesh room = both(ball({0, 0, 0}, 5.0), inwards(ball({0, 0, 0}, 4.9)));
    EXPECT_EQ(num_solid(both(room, ball({0, 0, 0}, 0.3))), 8u) << "furniture in a room";
}

}  // namespace
}  // namespace atrium::geometry
