#include "core/codec/mesh_codec.hpp"
#include "tests/support/shapes/closed_meshes.hpp"
#include "tests/support/shapes/decode_mesh.hpp"

#include <gtest/gtest.h>

#include <array>
#include <span>

namespace atrium::codec {
namespace {

TEST(MeshCodec, MeshesAfterEachOtherAreReadAsOne) {
    const std::array parts{
        test::make_torus(20, 10), test::make_sphere(3, 1.0), test::make_octahedron({0, 0, 0}, 0.1)};
    std::vector<std::uint8_t> bytes;
    std::vector<std::uint32_t> sizes;
    geometry::TriangleMesh expected;
    for (const geometry::TriangleMesh& part : parts) {
        std::vector<std::uint8_t> coded;
        ASSERT_TRUE(MeshEncoder().encode(part, {}, coded));
        bytes.insert(bytes.end(), coded.begin(), coded.end());
        sizes.push_back(static_cast<std::uint32_t>(coded.size()));
        geometry::append(expected, *test::decode_mesh(coded));
    }
    MeshDecoder decoder;
    geometry::TriangleMesh mesh;
    ASSERT_TRUE(decoder.decode(bytes, sizes, {}, mesh));
    EXPECT_EQ(mesh.vertices, expected.vertices);
    EXPECT_EQ(mesh.triangles, expected.triangles);
    // the limits hold for all together
    MeshLimits limits;
    limits.max_triangles = static_cast<std::uint32_t>(expected.triangles.size());
    EXPECT_TRUE(decoder.decode(bytes, sizes, limits, mesh));
    --limits.max_triangles;
    EXPECT_FALSE(decoder.decode(bytes, sizes, limits, mesh));
    // wrong sizes
    EXPECT_FALSE(decoder.decode(bytes, std::vector{sizes[0], sizes[1]}, {}, mesh));
    EXPECT_FALSE(decoder.decode(bytes, std::vector{sizes[0], sizes[1], sizes[2] + 1}, {}, mesh));
    EXPECT_FALSE(decoder.decode(bytes, std::vector{sizes[0], 0xffffffffU}, {}, mesh));
    // one mesh without sizes
    ASSERT_TRUE(decoder.decode(std::span(bytes).first(sizes[0]), {}, {}, mesh));
    EXPECT_EQ(mesh.triangles, test::decode_mesh(std::span(bytes).first(sizes[0]))->triangles);
}

}  // namespace
}  // namespace atrium::codec
