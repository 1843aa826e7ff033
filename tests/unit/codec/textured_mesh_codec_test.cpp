#include "core/codec/textured_mesh_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::codec {
namespace {

// A square of two triangles, twice the same place with other texture coordinates: as two charts
// that meet at an edge.
TexturedTriangles two_charts() {
    TexturedTriangles mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.uvs = {{0, 0}, {0.4f, 0}, {0.4f, 0.4f}, {0.6f, 0.6f}, {1, 1}, {0.6f, 1}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    return mesh;
}

// Corners of all triangles, in an order of their own.
std::vector<std::array<int, 5>> corners_of(const TexturedTriangles& mesh) {
    std::vector<std::array<int, 5>> corners;
    const auto rounded = [](float value) { return static_cast<int>(std::lround(value * 1000.0f)); };
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t v : triangle) {
            const Eigen::Vector3f& p = mesh.positions[v];
            const Eigen::Vector2f& uv = mesh.uvs[v];
            corners.push_back(
                {rounded(p.x()), rounded(p.y()), rounded(p.z()), rounded(uv.x()), rounded(uv.y())});
        }
    }
    std::ranges::sort(corners);
    return corners;
}

TEST(TexturedMeshCodec, KeepsPlacesAndTextureAcrossCharts) {
    const TexturedTriangles mesh = two_charts();
    const auto bytes = encode_textured(mesh, {});
    ASSERT_TRUE(bytes) << bytes.error().message;
    const auto decoded = decode_textured(*bytes);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(corners_of(*decoded), corners_of(mesh));
    EXPECT_EQ(decoded->positions.size(), 6u) << "a vertex per chart";
    EXPECT_EQ(*encode_textured(mesh, {}), *bytes) << "deterministic";
}

TEST(TexturedMeshCodec, LeavesOutWhatDrawsNothing) {
    TexturedTriangles mesh = two_charts();
    mesh.triangles.push_back({1, 1, 2});
    mesh.positions.emplace_back(9, 9, 9);
    mesh.uvs.emplace_back(0, 0);
    const auto decoded = decode_textured(*encode_textured(mesh, {}));
    ASSERT_TRUE(decoded);
    EXPECT_EQ(corners_of(*decoded), corners_of(two_charts()));
    EXPECT_EQ(decoded->positions.size(), 6u);
}

TEST(TexturedMeshCodec, RefusesWhatIsNoMesh) {
    EXPECT_FALSE(encode_textured({}, {}));
    TexturedTriangles mesh = two_charts();
    mesh.triangles.push_back({0, 1, 6});
    EXPECT_FALSE(encode_textured(mesh, {}));
    mesh = two_charts();
    mesh.uvs.pop_back();
    EXPECT_FALSE(encode_textured(mesh, {}));
    mesh = two_charts();
    mesh.positions[0].x() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(encode_textured(mesh, {}));
    mesh = two_charts();
    mesh.triangles = {{0, 0, 1}};
    EXPECT_FALSE(encode_textured(mesh, {}));
}

TEST(TexturedMeshCodec, RefusesBytesThatAreNoMesh) {
    EXPECT_FALSE(decode_textured(std::vector<std::uint8_t>{}));
    EXPECT_FALSE(decode_textured(std::vector<std::uint8_t>(100, 7)));
}

}  // namespace
}  // namespace atrium::codec
