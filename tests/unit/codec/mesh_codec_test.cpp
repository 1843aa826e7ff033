#include "core/codec/mesh_codec.hpp"

#include <gtest/gtest.h>

namespace {

using atrium::codec::decode_mesh;
using atrium::codec::encode_mesh;
using atrium::geometry::TriangleMesh;

TEST(MeshCodec, AnEmptyMeshIsZeroBytesAndBack) {
    std::vector<std::uint8_t> bytes{1, 2, 3};
    const auto size = encode_mesh({}, {}, bytes);
    ASSERT_TRUE(size.has_value());
    EXPECT_EQ(*size, 0U);
    EXPECT_TRUE(bytes.empty());
    const auto mesh = decode_mesh(bytes);
    ASSERT_TRUE(mesh.has_value());
    EXPECT_TRUE(mesh->empty());
}

TEST(MeshCodec, ATetrahedronComesBackWithItsTopologyAndVolume) {
    TriangleMesh tetrahedron;
    tetrahedron.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    std::vector<std::uint8_t> bytes;
    ASSERT_TRUE(encode_mesh(tetrahedron, {}, bytes).has_value());
    const auto mesh = decode_mesh(bytes);
    ASSERT_TRUE(mesh.has_value()) << mesh.error().message;
    const auto report = atrium::geometry::inspect(*mesh);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(mesh->vertices.size(), 4U);
    EXPECT_NEAR(report.volume_m3, 1.0 / 6.0, 1e-3);
}

}  // namespace
