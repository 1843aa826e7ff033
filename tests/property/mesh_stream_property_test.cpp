#include "core/codec/draco_reader.hpp"
#include "core/codec/edgebreaker_reader.hpp"
#include "core/codec/edgebreaker_writer.hpp"
#include "core/codec/mesh_codec.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/views/views_file.hpp"
#include "tests/property/draco_reference.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/closed_meshes.hpp"
#include "tests/support/shapes/hull_checks.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

// Compares the streams of meshes with those of Draco's encoder byte by byte, and the decoded meshes
// with those of Draco's decoder bit by bit.
namespace atrium::codec {
namespace {

using geometry::TriangleMesh;
using test::Bytes;
using test::draco_bytes;
using test::quantised;
using test::Random;
using test::Triangles;
using test::triangles_of;

template <typename T>
bool has_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool has_same_bits(const TriangleMesh& a, const TriangleMesh& b) {
    return has_same_bits(a.vertices, b.vertices) && has_same_bits(a.triangles, b.triangles);
}

constexpr MeshLimits kAnySize{.max_coordinate_m = 1e35};

MeshCodecOptions random_options(Random& random) {
    return {test::between(random, 8, 20), test::between(random, 2, 7)};
}

class MeshStream : public testing::Test {
protected:
    /// The writer, without Draco's help, must write Draco's bytes, and its reader must read them.
    void expect_written(const TriangleMesh& mesh, const MeshCodecOptions& options) {
        ASSERT_TRUE(EdgebreakerWriter::takes_speed(options.speed));
        draco::EncoderBuffer buffer;
        ASSERT_TRUE(writer_.write(mesh, options.position_bits, options.speed, buffer));
        const Bytes bytes(buffer.data(), buffer.data() + buffer.size());
        EXPECT_TRUE(bytes == draco_bytes(mesh, options))
            << mesh.triangles.size() << " triangles, " << options.position_bits << " bits, speed "
            << options.speed;
        EXPECT_TRUE(triangles_of(bytes) == quantised(mesh, options.position_bits));
        TriangleMesh expected;
        ASSERT_TRUE(reader_.read(bytes, kAnySize, read_)) << "only Draco could read it";
        ASSERT_TRUE(read_with_draco(bytes, kAnySize, expected));
        EXPECT_TRUE(has_same_bits(read_, expected)) << mesh.triangles.size() << " triangles";
    }

    /// The encoder, with either writer, must do as Draco does, including errors.
    void expect_as_draco(const TriangleMesh& mesh, const MeshCodecOptions& options) {
        Bytes bytes;
        const bool is_coded = encoder_.encode(mesh, options, bytes).has_value();
        const Bytes expected = draco_bytes(mesh, options);
        EXPECT_EQ(is_coded, !expected.empty());
        EXPECT_EQ(bytes, expected) << mesh.triangles.size() << " triangles";
        if (is_coded) expect_read_as_draco(bytes);
    }

    /// Either reader must do as Draco does, including errors. Returns whether it read without
    /// Draco.
    bool expect_read_as_draco(const Bytes& bytes) {
        TriangleMesh expected;
        const auto draco = read_with_draco(bytes, kAnySize, expected);
        const auto decoded = decoder_.decode(bytes, kAnySize, decoded_);
        EXPECT_EQ(decoded.has_value(), draco.has_value());
        if (!draco && !decoded) {
            EXPECT_EQ(decoded.error().message, draco.error().message);
        }
        if (draco && decoded) {
            EXPECT_TRUE(has_same_bits(decoded_, expected));
        }
        return reader_.read(bytes, kAnySize, read_);
    }

    bool is_written(const TriangleMesh& mesh) {
        draco::EncoderBuffer buffer;
        const bool is_written = writer_.write(mesh, 11, 7, buffer);
        EXPECT_EQ(buffer.size() > 0, is_written);
        return is_written;
    }

    // shared by all meshes of a test, to find leftovers
    EdgebreakerWriter writer_;
    MeshEncoder encoder_;
    EdgebreakerReader reader_;
    MeshDecoder decoder_;
    TriangleMesh read_;
    TriangleMesh decoded_;
};

TEST_F(MeshStream, EqualsDracosForShuffledClosedMeshes) {
    Random random(31);
    for (int round = 0; round < 120; ++round) {
        TriangleMesh mesh =
            round % 4 == 0
                ? test::make_sphere(test::between(random, 0, 4), 0.8)
                : test::make_torus(static_cast<std::uint32_t>(test::between(random, 3, 50)),
                                   static_cast<std::uint32_t>(test::between(random, 3, 30)));
        for (int more = round % 5; more > 0; --more) {
            const Eigen::Vector3d centre = test::random_in_cube(random, 2.0);
            geometry::append(mesh, test::make_octahedron(centre, test::between(random, 1e-5, 0.3)));
            if (more % 2 == 0) geometry::append(mesh, test::make_torus(5, 4));
        }
        for (auto& vertex : mesh.vertices)
            vertex += test::random_in_cube(random, 0.02 * (round % 3));
        std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
        for (auto& triangle : mesh.triangles)
            std::rotate(triangle.begin(), triangle.begin() + random() % 3, triangle.end());
        expect_written(mesh, random_options(random));
    }
}

using Triangle = std::array<std::uint32_t, 3>;

bool meets(const Triangle& triangle, const std::set<std::uint32_t>& vertices) {
    return std::any_of(
        triangle.begin(), triangle.end(), [&](auto v) { return vertices.contains(v); });
}

/// A torus with tubes between places of its surface. Each tube adds a handle.
TriangleMesh make_knot(int num_tubes, Random& random) {
    const TriangleMesh torus = test::make_torus(40, 30);
    std::vector<Triangle> mouths;
    std::set<std::uint32_t> taken;  // by mouths and their neighbours
    while (mouths.size() < 2 * static_cast<std::size_t>(num_tubes)) {
        const Triangle& mouth = torus.triangles[random() % torus.triangles.size()];
        if (meets(mouth, taken)) continue;
        mouths.push_back(mouth);
        const std::set<std::uint32_t> own(mouth.begin(), mouth.end());
        for (const Triangle& triangle : torus.triangles) {
            if (meets(triangle, own)) taken.insert(triangle.begin(), triangle.end());
        }
    }
    TriangleMesh knot{torus.vertices, {}};
    std::copy_if(
        torus.triangles.begin(),
        torus.triangles.end(),
        std::back_inserter(knot.triangles),
        [&](const Triangle& t) { return std::count(mouths.begin(), mouths.end(), t) == 0; });
    for (std::size_t i = 0; i < mouths.size(); i += 2) {
        const auto& [a, b, c] = mouths[i];
        const auto& [x, z, y] = mouths[i + 1];  // seen from inside the tube: the other direction
        for (const auto& [p, q, r, s] :
             {std::array{a, b, x, y}, std::array{b, c, y, z}, std::array{c, a, z, x}}) {
            knot.triangles.push_back({p, q, s});
            knot.triangles.push_back({p, s, r});
        }
    }
    std::shuffle(knot.triangles.begin(), knot.triangles.end(), random);
    return knot;
}

// Where a handle's loop meets itself, the mesh was split before.
TEST_F(MeshStream, EqualsDracosForSurfacesWithManyHandles) {
    Random random(32);
    for (int num_tubes = 0; num_tubes < 20; ++num_tubes) {
        const TriangleMesh knot = make_knot(num_tubes, random);
        const geometry::MeshReport report = geometry::inspect(knot);
        ASSERT_TRUE(report.manifold) << "the test mesh is not manifold";
        ASSERT_EQ(report.euler_characteristic, -2 * num_tubes);
        expect_written(knot, random_options(random));
    }
}

TEST_F(MeshStream, EqualsDracosForHulls) {
    Random random(33);
    int num_handles = 0;
    for (int round = 0; round < 20; ++round) {
        std::vector<hull::SilhouetteView> views;
        for (const auto& camera : test::make_ring_rig({.num_cameras = 3 + round % 4}))
            views.push_back(test::make_view(camera, test::random_stars(random, 30)));
        const hull::VisualHull hull = test::exact_hull_of(views);
        ASSERT_EQ(hull.status, hull::HullStatus::kOk) << round;
        const geometry::MeshReport report = geometry::inspect(hull.mesh);
        num_handles += static_cast<int>(report.num_components) -
                       static_cast<int>(report.euler_characteristic / 2);
        expect_written(hull.mesh, random_options(random));
    }
    EXPECT_GT(num_handles, 0);
}

TEST_F(MeshStream, EqualsDracosForHullsOfRealOutlines) {
    const std::filesystem::path folder = atrium::test::source_dir() + "/../shared/data/hulls";
    if (!std::filesystem::exists(folder))
        GTEST_SKIP() << atrium::test::skip::kNoSharedData << folder;
    for (const char* set : {"person_1px", "person_10k", "person_24views", "torus", "spheres"}) {
        const auto loaded = views::load_views_file(folder / (std::string(set) + ".json"));
        ASSERT_TRUE(loaded) << loaded.error().message;
        std::vector<hull::SilhouetteView> views;
        for (const auto& view : *loaded) views.push_back(view.view);
        const hull::VisualHull hull = test::exact_hull_of(views);
        ASSERT_EQ(hull.status, hull::HullStatus::kOk);
        for (const int speed : {2, 5, 7}) expect_written(hull.mesh, {11, speed});
        expect_written(hull.mesh, {14, 7});
    }
}

TEST_F(MeshStream, EqualsDracosForMeshesOnFewPoints) {
    Random random(34);
    for (int round = 0; round < 40; ++round) {
        TriangleMesh mesh = test::make_torus(12, 9);
        for (auto& vertex : mesh.vertices)
            vertex = mesh.vertices[random() % static_cast<std::uint64_t>(1 + round)];
        expect_written(mesh, random_options(random));
    }
    TriangleMesh far = test::make_sphere(2, 1.0);
    for (auto& vertex : far.vertices) vertex = 1e30 * vertex;
    expect_written(far, {11, 7});
}

TEST_F(MeshStream, IsWrittenByDracoUnlessTheMeshIsAClosed2Manifold) {
    const TriangleMesh good = test::make_torus(8, 6);
    ASSERT_TRUE(is_written(good));
    std::map<std::string, TriangleMesh> meshes;
    meshes["a triangle less"] = good;
    meshes["a triangle less"].triangles.pop_back();
    meshes["a triangle twice"] = good;
    meshes["a triangle twice"].triangles.push_back(good.triangles[5]);
    meshes["a triangle turned over"] = good;
    std::swap(meshes["a triangle turned over"].triangles[3][0],
              meshes["a triangle turned over"].triangles[3][1]);
    meshes["a triangle of two vertices"] = good;
    meshes["a triangle of two vertices"].triangles.push_back({1, 1, 2});
    meshes["a vertex of no triangle"] = good;
    meshes["a vertex of no triangle"].vertices.emplace_back(3.0, 0.0, 0.0);
    meshes["two bodies on one vertex"] = good;
    geometry::append(meshes["two bodies on one vertex"], good);
    for (auto& triangle : meshes["two bodies on one vertex"].triangles)
        std::replace(triangle.begin(), triangle.end(), 48U, 7U);
    meshes["two triangles back to back"] = good;
    const auto base = static_cast<std::uint32_t>(good.vertices.size());
    geometry::append(meshes["two triangles back to back"], {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}});
    meshes["two triangles back to back"].triangles.push_back({base, base + 1, base + 2});
    meshes["two triangles back to back"].triangles.push_back({base, base + 2, base + 1});
    for (const auto& [what, mesh] : meshes) {
        SCOPED_TRACE(what);
        EXPECT_FALSE(is_written(mesh));
        expect_as_draco(mesh, {11, 7});
        expect_as_draco(good, {11, 7});
    }
}

TEST_F(MeshStream, EqualsDracosAtOtherSpeeds) {
    const TriangleMesh mesh = test::make_torus(20, 12);
    for (const int speed : {0, 1, 8, 9, 10}) {
        EXPECT_FALSE(EdgebreakerWriter::takes_speed(speed));
        expect_as_draco(mesh, {12, speed});
    }
}

// Some damaged streams are still meshes, which must then be the same for both readers.
TEST_F(MeshStream, IsReadLikeDracoIfDamaged) {
    Random random(36);
    std::vector<Bytes> streams;
    const auto add = [&](const TriangleMesh& mesh, const MeshCodecOptions& options) {
        encoder_.encode(mesh, options, streams.emplace_back());
        EXPECT_TRUE(reader_.read(streams.back(), kAnySize, read_));
    };
    add(test::make_octahedron({0, 0, 0}, 1.0), {8, 7});
    add(test::make_torus(5, 4), {11, 7});
    add(test::make_torus(12, 6), {14, 7});
    add(make_knot(3, random), {11, 5});
    TriangleMesh two = test::make_sphere(1, 1.0);
    geometry::append(two, test::make_torus(6, 5));
    add(two, {11, 7});
    int num_read = 0;
    for (int round = 0; round < 20'000; ++round) {
        Bytes bytes = streams[static_cast<std::size_t>(round) % streams.size()];
        for (int damage = test::between(random, 1, 3); damage > 0; --damage) {
            std::uint8_t& byte = bytes[random() % bytes.size()];
            byte =
                static_cast<std::uint8_t>(round % 2 == 0 ? byte ^ (1U << random() % 8) : random());
        }
        if (round % 50 == 0) bytes.resize(1 + random() % (bytes.size() - 1));
        num_read += expect_read_as_draco(bytes) ? 1 : 0;
    }
    EXPECT_GT(num_read, 1000);
}

// With a few vertices, nearly every mesh has too many or too few triangles at an edge. Damaged
// closed meshes have few of these.
TEST_F(MeshStream, EqualsDracosForTriangleSoups) {
    Random random(35);
    int num_written = 0;
    for (int round = 0; round < 1500; ++round) {
        TriangleMesh mesh;
        if (round % 2 == 0) {
            const auto num_vertices = static_cast<std::uint32_t>(test::between(random, 3, 12));
            mesh.vertices.resize(num_vertices);
            for (int i = test::between(random, 1, 30); i > 0; --i)
                mesh.triangles.push_back({static_cast<std::uint32_t>(random() % num_vertices),
                                          static_cast<std::uint32_t>(random() % num_vertices),
                                          static_cast<std::uint32_t>(random() % num_vertices)});
        } else {
            mesh = test::make_octahedron({0, 0, 0}, 1.0);
            geometry::append(mesh, test::make_torus(4, 3));
            for (int damage = test::between(random, 0, 2); damage > 0; --damage)
                mesh.triangles[random() % mesh.triangles.size()][random() % 3] =
                    static_cast<std::uint32_t>(random() % mesh.vertices.size());
        }
        for (auto& vertex : mesh.vertices) vertex = test::random_in_cube(random, 1.0);
        num_written += is_written(mesh) ? 1 : 0;
        expect_as_draco(mesh, random_options(random));
    }
    EXPECT_GT(num_written, 100);
    EXPECT_LT(num_written, 1000);
}

}  // namespace
}  // namespace atrium::codec
