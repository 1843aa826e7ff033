#include "core/codec/mesh_codec.hpp"

#include "tests/support/shapes/closed_meshes.hpp"
#include "tests/support/shapes/decode_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <string>

namespace atrium::codec {
namespace {

using geometry::TriangleMesh;
using test::make_octahedron;
using test::make_sphere;
using test::make_torus;
using ::testing::HasSubstr;
using Random = std::mt19937_64;

double number(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

std::vector<std::uint8_t> encode(const TriangleMesh& mesh, const MeshCodecOptions& options = {}) {
    std::vector<std::uint8_t> bytes;
    const auto size = MeshEncoder().encode(mesh, options, bytes);
    EXPECT_TRUE(size.has_value()) << size.error().message;
    return bytes;
}

TriangleMesh there_and_back(const TriangleMesh& mesh, const MeshCodecOptions& options = {}) {
    auto decoded = test::decode_mesh(encode(mesh, options));
    EXPECT_TRUE(decoded.has_value()) << decoded.error().message;
    return decoded ? *decoded : TriangleMesh{};
}

/// Step of the grid.
double step_m(const TriangleMesh& mesh, const MeshCodecOptions& options) {
    return geometry::bounds(mesh).size().maxCoeff() / ((1 << options.position_bits) - 1);
}

/// Half a step on each axis plus the rounding of the conversion to float.
double allowed_error_m(const TriangleMesh& mesh, const MeshCodecOptions& options) {
    const geometry::Aabb box = geometry::bounds(mesh);
    const double largest_m = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
    return 0.5 * step_m(mesh, options) + 4.0 * 6e-8 * largest_m;
}

/// Index of the vertex of `mesh` nearest to `p` in the maximum norm.
std::uint32_t nearest(const TriangleMesh& mesh, const Eigen::Vector3d& p) {
    const auto found =
        std::min_element(mesh.vertices.begin(), mesh.vertices.end(), [&](auto& a, auto& b) {
            return (a - p).cwiseAbs().maxCoeff() < (b - p).cwiseAbs().maxCoeff();
        });
    return static_cast<std::uint32_t>(found - mesh.vertices.begin());
}

using Triangles = std::multiset<std::array<std::uint32_t, 3>>;

/// The triangles, each rotated to begin with its smallest index.
Triangles canonical(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    Triangles out;
    for (auto triangle : triangles) {
        std::rotate(
            triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
        out.insert(triangle);
    }
    return out;
}

void expect_same_mesh_renumbered(const TriangleMesh& mesh, const MeshCodecOptions& options) {
    const TriangleMesh decoded = there_and_back(mesh, options);
    ASSERT_EQ(decoded.vertices.size(), mesh.vertices.size());
    std::vector<std::uint32_t> original_of;
    for (const Eigen::Vector3d& vertex : decoded.vertices) {
        original_of.push_back(nearest(mesh, vertex));
        EXPECT_LE((mesh.vertices[original_of.back()] - vertex).cwiseAbs().maxCoeff(),
                  allowed_error_m(mesh, options));
    }
    auto triangles = decoded.triangles;
    for (auto& triangle : triangles) {
        for (auto& vertex : triangle) vertex = original_of[vertex];
    }
    EXPECT_EQ(canonical(triangles), canonical(mesh.triangles));
}

void expect_same_topology(const TriangleMesh& mesh, const MeshCodecOptions& options = {}) {
    const geometry::MeshReport before = geometry::inspect(mesh);
    ASSERT_TRUE(before.closed && before.manifold) << "the test mesh is not closed and manifold";
    const TriangleMesh decoded = there_and_back(mesh, options);
    const geometry::MeshReport after = geometry::inspect(decoded);
    EXPECT_TRUE(after.closed);
    EXPECT_TRUE(after.manifold);
    EXPECT_EQ(decoded.vertices.size(), mesh.vertices.size());
    EXPECT_EQ(decoded.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(after.num_components, before.num_components);
    EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
}

TEST(MeshCodec, EmptyMeshIsZeroBytesBothWays) {
    std::vector<std::uint8_t> bytes{1, 2, 3};
    const auto size = MeshEncoder().encode({}, {}, bytes);
    ASSERT_TRUE(size.has_value());
    EXPECT_EQ(*size, 0U);
    EXPECT_TRUE(bytes.empty());
    const auto mesh = test::decode_mesh(bytes);
    ASSERT_TRUE(mesh.has_value());
    EXPECT_TRUE(mesh->empty());
}

TEST(MeshCodec, MovesCoordinatesByAtMostHalfAStepAndKeepsTriangles) {
    Random random(21);
    for (int round = 0; round < 12; ++round) {
        MeshCodecOptions options;
        options.position_bits = 11 + round % 6;
        options.speed = round % 11;
        TriangleMesh mesh = round % 2 == 0 ? make_sphere(3, number(random, 0.2, 1.5))
                                           : make_torus(20, 12, number(random, 0.1, 0.5));
        const Eigen::Vector3d offset_m(number(random, -9, 9), number(random, -9, 9), 1.0);
        for (auto& vertex : mesh.vertices) {
            for (double& component : vertex) component += number(random, -0.005, 0.005);
            vertex += offset_m;
        }
        expect_same_mesh_renumbered(mesh, options);
    }
}

geometry::CalibratedCamera camera_towards(const Eigen::Vector3d& target,
                                          const Eigen::Vector3d& centre,
                                          double focal_px) {
    geometry::CalibratedCamera camera;
    camera.intrinsics = {.width = 1000, .height = 1000, .fx = focal_px, .fy = 0.97 * focal_px};
    const auto rotation =
        Eigen::Quaterniond::FromTwoVectors(target - centre, Eigen::Vector3d::UnitZ());
    camera.camera_from_site = {rotation, -(rotation * centre)};
    return camera;
}

TEST(MeshCodec, AutomaticBitsMoveVerticesLessThanACameraCanSee) {
    Random random(27);
    int fewest = 99;
    int most = 0;
    for (int round = 0; round < 30; ++round) {
        const TriangleMesh mesh = make_torus(20, 12, number(random, 0.1, 0.5));
        std::vector<geometry::CalibratedCamera> cameras;
        for (int i = 0; i < 4; ++i) {
            const double turn = number(random, 0.0, 6.28);
            const double far_m = number(random, 1.7, 9.0);
            cameras.push_back(camera_towards({number(random, -0.2, 0.2), 0, 0},
                                             {far_m * std::cos(turn), far_m * std::sin(turn), 1.0},
                                             number(random, 100, 3000)));
        }
        const int bits = position_bits_for(mesh, cameras);
        ASSERT_GT(bits, 8);
        ASSERT_LT(bits, 16) << "the test needs a number of bits below the maximum";
        fewest = std::min(fewest, bits);
        most = std::max(most, bits);
        const TriangleMesh decoded = there_and_back(mesh, {.position_bits = bits});
        double farthest_px = 0.0;
        for (const Eigen::Vector3d& vertex : decoded.vertices) {
            const Eigen::Vector3d& original = mesh.vertices[nearest(mesh, vertex)];
            for (const auto& camera : cameras) {
                const Eigen::Vector2d before =
                    camera.intrinsics.project(camera.camera_from_site * original);
                const Eigen::Vector2d after =
                    camera.intrinsics.project(camera.camera_from_site * vertex);
                farthest_px = std::max(farthest_px, (after - before).norm());
            }
        }
        EXPECT_LE(farthest_px, 0.44);
        EXPECT_GT(farthest_px, 0.05) << "more bits than necessary";
    }
    EXPECT_LT(fewest, most);
}

// Allowance for rounding in float.
TEST(MeshCodec, AutomaticBitsAreTheFewestWithShortEnoughSteps) {
    Random random(28);
    for (int round = 0; round < 300; ++round) {
        const TriangleMesh mesh = make_torus(20, 12, number(random, 0.1, 0.5));
        std::vector<geometry::CalibratedCamera> cameras;
        double most_px_per_m = 0.0;
        for (int i = 0; i < 3; ++i) {
            // some look at the mesh from inside
            const double turn = number(random, 0.0, 6.28);
            const double far_m = number(random, 0.0, round % 3 == 0 ? 80.0 : 5.0) + 0.1;
            cameras.push_back(camera_towards({number(random, -0.2, 0.2), 0, 0},
                                             {far_m * std::cos(turn), far_m * std::sin(turn), 0.5},
                                             number(random, 100, 3000)));
            for (const Eigen::Vector3d& vertex : mesh.vertices) {
                const Eigen::Vector3d seen = cameras.back().camera_from_site * vertex;
                if (seen.z() <= 0.0) continue;
                const double focal_px =
                    std::max(cameras.back().intrinsics.fx, cameras.back().intrinsics.fy);
                most_px_per_m =
                    std::max(most_px_per_m, focal_px * seen.norm() / (seen.z() * seen.z()));
            }
        }
        const int bits = position_bits_for(mesh, cameras);
        const auto step_px = [&](int num_bits) {
            return most_px_per_m * step_m(mesh, {.position_bits = num_bits});
        };
        if (bits < 16) {
            EXPECT_LE(step_px(bits), 2.0 * kStepInTexturePixels);
        }
        if (bits > 8) {
            EXPECT_GT(step_px(bits - 1), 2.0 * kStepInTexturePixels);
        }
    }
}

TEST(MeshCodec, AutomaticBitsAreDefinedIfNoCameraSeesTheMesh) {
    const TriangleMesh mesh = make_torus(20, 12);
    EXPECT_EQ(position_bits_for(mesh, {}), 14);
    const std::array behind{camera_towards({9, 0, 0}, {4, 0, 0}, 1000.0)};
    EXPECT_EQ(position_bits_for(mesh, behind), 14);
    // nearly on the surface: the limit
    const std::array near{camera_towards({0, 0, 0}, {1.001, 0, 0}, 5000.0)};
    EXPECT_EQ(position_bits_for(mesh, near), 16);
}

TEST(MeshCodec, KeepsTheTopologyOfSphereTorusAndManyBodies) {
    expect_same_topology(make_sphere(4, 0.9));
    expect_same_topology(make_torus(60, 30));
    Random random(22);
    TriangleMesh crowd;
    for (int i = 0; i < 300; ++i) {
        const Eigen::Vector3d centre(number(random, -2, 2), number(random, -2, 2), 1.0);
        append(crowd, make_octahedron(centre, number(random, 1e-6, 0.1)));
    }
    append(crowd, make_torus(16, 8));
    expect_same_topology(crowd);
}

TEST(MeshCodec, KeepsTheTopologyOfVerticesThatCoincideOnTheGrid) {
    // Edges of 0.1 um in a mesh of 2 m, where a step is a thousand times as long: a tube so thin
    // that each ring is one grid point, and overlapping bodies smaller than a step.
    TriangleMesh thin = make_torus(200, 6, 1e-7);
    for (int i = 0; i < 20; ++i) append(thin, make_octahedron({0.1, 0.2, 0.3}, 1e-7));
    for (const int speed : {0, 5, 7, 10}) expect_same_topology(thin, {14, speed});
    // All vertices in one point.
    TriangleMesh point = make_torus(8, 8);
    for (auto& vertex : point.vertices) vertex = {1, 2, 3};
    expect_same_topology(point);
}

TEST(MeshCodec, KeepsTheTopologyOfRandomlyCrumpledMeshes) {
    Random random(23);
    for (int round = 0; round < 40; ++round) {
        TriangleMesh mesh = make_torus(4 + random() % 30, 3 + random() % 20);
        if (round % 3 == 0) append(mesh, make_sphere(2, 0.5));
        // Half of the vertices coincide with others or lie within a fraction of a step.
        for (auto& vertex : mesh.vertices) {
            if (random() % 2 == 0) continue;
            vertex = mesh.vertices[random() % mesh.vertices.size()];
            vertex += Eigen::Vector3d::Constant(number(random, -1e-7, 1e-7));
        }
        std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
        expect_same_topology(mesh, {14, static_cast<int>(random() % 11)});
    }
}

TEST(MeshCodec, SplitsSharedVerticesByFanAndDropsUnusedOnes) {
    TriangleMesh mesh = make_octahedron({0, 0, 0}, 0.5);
    append(mesh, make_octahedron({1, 0, 0}, 0.5));  // its vertex 7 coincides with vertex 0
    for (auto& triangle : mesh.triangles) std::replace(triangle.begin(), triangle.end(), 7U, 0U);
    ASSERT_FALSE(geometry::inspect(mesh).manifold);
    const TriangleMesh decoded = there_and_back(mesh);
    EXPECT_EQ(decoded.vertices.size(), 12U);  // vertex 7 is unused, vertex 0 appears twice
    const auto report = geometry::inspect(decoded);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.num_components, 2U);
}

TEST(MeshCodec, RefusesToEncodeBadMeshes) {
    std::vector<std::uint8_t> bytes;
    TriangleMesh mesh = make_octahedron({0, 0, 0}, 1.0);
    mesh.triangles[3][1] = 6;
    EXPECT_THAT(MeshEncoder().encode(mesh, {}, bytes).error().message, HasSubstr("index"));
    mesh = make_octahedron({0, 0, 0}, 1.0);
    mesh.vertices[2].y() = std::nan("");
    EXPECT_THAT(MeshEncoder().encode(mesh, {}, bytes).error().message, HasSubstr("finite"));
    mesh.vertices[2].y() = 1e300;  // exceeds float
    EXPECT_FALSE(MeshEncoder().encode(mesh, {}, bytes).has_value());
    mesh = make_octahedron({0, 0, 0}, 1.0);
    for (auto& triangle : mesh.triangles) triangle = {1, 1, 2};
    EXPECT_FALSE(MeshEncoder().encode(mesh, {}, bytes).has_value())
        << "a mesh without any remaining triangle was encoded";
    EXPECT_TRUE(bytes.empty());
}

TEST(MeshCodec, RefusesCoordinatesAndCountsBeyondTheLimits) {
    const auto bytes = encode(make_torus(20, 10));  // 400 triangles, 200 vertices
    EXPECT_THAT(test::decode_mesh(bytes, {.max_triangles = 399}).error().message,
                HasSubstr("triangles"));
    EXPECT_THAT(test::decode_mesh(bytes, {.max_vertices = 199}).error().message,
                HasSubstr("vertices"));
    EXPECT_THAT(test::decode_mesh(bytes, {.max_coordinate_m = 0.9}).error().message,
                HasSubstr("more than 0.9 m from the origin"));
    EXPECT_TRUE(test::decode_mesh(bytes, {400, 200, 1.1}).has_value());
}

TEST(MeshCodec, RefusesEveryTruncation) {
    const auto bytes = encode(make_torus(20, 10));
    for (std::size_t size = 1; size < bytes.size(); ++size)
        EXPECT_FALSE(test::decode_mesh(std::span(bytes).first(size)).has_value()) << size;
}

void expect_harmless(std::span<const std::uint8_t> bytes, const MeshLimits& limits) {
    const auto mesh = test::decode_mesh(bytes, limits);
    if (!mesh) {
        EXPECT_EQ(mesh.error().kind, ErrorKind::kInvalidData);
        return;
    }
    EXPECT_LE(mesh->vertices.size(), limits.max_vertices);
    EXPECT_LE(mesh->triangles.size(), limits.max_triangles);
    for (const auto& vertex : mesh->vertices)
        ASSERT_LE(vertex.cwiseAbs().maxCoeff(), limits.max_coordinate_m);
    for (const auto& triangle : mesh->triangles)
        ASSERT_LT(*std::max_element(triangle.begin(), triangle.end()), mesh->vertices.size());
}

TEST(MeshCodec, SurvivesFlippedBits) {
    Random random(24);
    const MeshLimits limits{.max_triangles = 5000, .max_vertices = 5000};
    const std::array streams{encode(make_torus(12, 6)),
                             encode(make_sphere(2, 1.0), {14, 0}),
                             encode(make_torus(5, 5), {10, 10})};
    for (int round = 0; round < 6'000; ++round) {
        auto bytes = streams[static_cast<std::size_t>(round) % streams.size()];
        for (std::uint64_t flips = 1 + random() % 4; flips > 0; --flips)
            bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
        expect_harmless(bytes, limits);
    }
}

TEST(MeshCodec, SurvivesRandomBytesAfterAValidBeginning) {
    Random random(25);
    const auto good = encode(make_torus(12, 6));
    for (int round = 0; round < 6'000; ++round) {
        std::vector<std::uint8_t> bytes(random() % 600);
        for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
        const std::size_t num_good = random() % good.size();
        std::copy_n(good.begin(), std::min(num_good, bytes.size()), bytes.begin());
        expect_harmless(bytes, {});
    }
}

TEST(MeshCodec, OneDecoderReadsGoodMeshesAfterDamagedOrEmptyOnes) {
    const std::array streams{encode(make_torus(20, 10)),
                             encode(make_sphere(3, 1.0), {12, 0}),  // Draco decodes this one
                             encode(make_octahedron({0, 0, 0}, 0.1), {14, 7})};
    MeshDecoder decoder;
    TriangleMesh mesh;
    for (std::size_t round = 0; round < 30; ++round) {
        const auto& good = streams[round % streams.size()];
        ASSERT_TRUE(decoder.decode(good, {}, mesh).has_value());
        const auto expected = test::decode_mesh(good);
        EXPECT_EQ(mesh.vertices, expected->vertices);
        EXPECT_EQ(mesh.triangles, expected->triangles);
        auto bad = good;
        bad.resize(good.size() * (round + 1) / 31);
        EXPECT_FALSE(decoder.decode(bad, {}, mesh).has_value());
        ASSERT_TRUE(decoder.decode({}, {}, mesh).has_value());
        EXPECT_TRUE(mesh.empty());
        EXPECT_TRUE(mesh.vertices.empty());
    }
}

TEST(MeshCodec, RefusesAStreamOfAnotherForm) {
    const auto good = encode(make_torus(5, 5));
    // Version, geometry type, method, flags, symbol type: each selects another decoder.
    for (const std::size_t position : {5U, 6U, 7U, 8U, 9U, 10U, 11U}) {
        auto bytes = good;
        bytes[position] ^= 1U;
        const auto mesh = test::decode_mesh(bytes);
        ASSERT_FALSE(mesh.has_value());
        EXPECT_THAT(mesh.error().message, HasSubstr("Draco 2.2 edgebreaker"));
    }
}

}  // namespace
}  // namespace atrium::codec
