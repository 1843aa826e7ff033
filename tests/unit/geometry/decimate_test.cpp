#include "core/geometry/decimate.hpp"

#include "core/geometry/collapse_map.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/shapes/surface_distance.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace atrium::geometry {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

// A closed grid of num_u x num_v quads on a torus, each vertex moved by up to `noise_m`.
TriangleMesh torus(std::uint32_t num_u, std::uint32_t num_v, double noise_m = 0.0) {
    TriangleMesh mesh;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> noise(-noise_m, noise_m);
    for (std::uint32_t i = 0; i < num_u; ++i) {
        for (std::uint32_t j = 0; j < num_v; ++j) {
            const double u = 2.0 * std::numbers::pi * i / num_u;
            const double v = 2.0 * std::numbers::pi * j / num_v;
            const double r = 0.5 + 0.2 * std::cos(v);
            mesh.vertices.emplace_back(r * std::cos(u) + noise(random),
                                       r * std::sin(u) + noise(random),
                                       0.2 * std::sin(v) + noise(random));
            const auto at = [&](std::uint32_t a, std::uint32_t b) {
                return (a % num_u) * num_v + b % num_v;
            };
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

// A cube of 1 m. Each side is a grid of n x n squares.
TriangleMesh gridded_cube(int n) {
    TriangleMesh mesh;
    std::vector<std::int64_t> index(static_cast<std::size_t>((n + 1) * (n + 1) * (n + 1)), -1);
    const auto at = [&](const Eigen::Vector3i& p) {
        auto& i = index[static_cast<std::size_t>((p.x() * (n + 1) + p.y()) * (n + 1) + p.z())];
        if (i < 0) {
            i = static_cast<std::int64_t>(mesh.vertices.size());
            mesh.vertices.push_back(p.cast<double>() / n);
        }
        return static_cast<std::uint32_t>(i);
    };
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3);
        const Eigen::Vector3i v = Eigen::Vector3i::Unit((axis + 2) % 3);
        for (int side = 0; side < 2; ++side) {
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < n; ++j) {
                    const Eigen::Vector3i p =
                        side * n * Eigen::Vector3i::Unit(axis) + i * u + j * v;
                    const auto a = at(p), b = at(p + u), c = at(p + u + v), d = at(p + v);
                    if (side == 1) {
                        mesh.triangles.push_back({a, b, c});
                        mesh.triangles.push_back({a, c, d});
                    } else {
                        mesh.triangles.push_back({a, c, b});
                        mesh.triangles.push_back({a, d, c});
                    }
                }
            }
        }
    }
    return mesh;
}

TriangleMesh tetrahedron() {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    return mesh;
}

struct Result {
    DecimateReport report;
    TriangleMesh mesh;
};

Result decimated(const TriangleMesh& in, const DecimateOptions& options) {
    DecimateScratch scratch;
    Result result;
    const auto report = decimate(in, options, scratch, result.mesh);
    EXPECT_TRUE(report) << report.error().message;
    if (report) result.report = *report;
    return result;
}

void expect_same_topology(const TriangleMesh& in, const TriangleMesh& out) {
    const MeshReport before = inspect(in);
    const MeshReport after = inspect(out);
    EXPECT_TRUE(after.manifold);
    EXPECT_EQ(after.num_components, before.num_components);
    EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
}

TEST(Decimate, LeavesOnlyTheCornersOfACube) {
    const TriangleMesh cube = gridded_cube(8);
    ASSERT_TRUE(inspect(cube).manifold);
    const Result result = decimated(cube, {.max_distance_m = 1e-9});
    EXPECT_EQ(result.mesh.vertices.size(), 8u);
    EXPECT_EQ(result.mesh.triangles.size(), 12u);
    EXPECT_NEAR(volume_m3(result.mesh), 1.0, 1e-12);
    EXPECT_LT(result.report.distance_bound_m, 1e-12);
    EXPECT_EQ(result.report.num_collapses, cube.vertices.size() - 8);
}

TEST(Decimate, KeepsTheHoleOfATorusForAnyTolerance) {
    const TriangleMesh in = torus(60, 30, 2e-3);
    const Result result = decimated(in, {.max_distance_m = 10.0});
    expect_same_topology(in, result.mesh);
    EXPECT_LT(result.mesh.triangles.size(), 100u);
    EXPECT_GT(volume_m3(result.mesh), 0.0);
}

TEST(Decimate, StaysWithinItsStatedBound) {
    const TriangleMesh in = torus(60, 30, 2e-3);
    std::size_t former = in.triangles.size() + 1;
    for (const double max_m : {1e-3, 3e-3, 10e-3, 30e-3}) {
        const Result result = decimated(in, {.max_distance_m = max_m});
        expect_same_topology(in, result.mesh);
        EXPECT_LT(result.mesh.triangles.size(), former);
        former = result.mesh.triangles.size();
        const double bound = result.report.distance_bound_m;
        EXPECT_LE(bound, max_m);
        const double there = test::SurfaceDistance(result.mesh).largest_m(in, 1000);
        const double back = test::SurfaceDistance(in).largest_m(result.mesh, 1000);
        EXPECT_LE(there, bound);
        EXPECT_LE(back, bound);
        // the bound stays useful: detours of many coarse steps make it at most three times as large
        EXPECT_GT(std::max(there, back), bound / 3.0);
    }
    EXPECT_LT(former, in.triangles.size() / 5);
}

TEST(Decimate, StopsAtTheTarget) {
    const TriangleMesh in = torus(40, 20);
    const Result reached = decimated(in, {.max_distance_m = 0.1, .target_triangles = 500});
    EXPECT_EQ(reached.mesh.triangles.size(), 500u);
    EXPECT_TRUE(reached.report.reached_target);
    const Result stopped = decimated(in, {.max_distance_m = 1e-3, .target_triangles = 10});
    EXPECT_GT(stopped.mesh.triangles.size(), 10u);
    EXPECT_FALSE(stopped.report.reached_target);
}

TEST(Decimate, KeepsASubsetOfTheVerticesInOrder) {
    const TriangleMesh in = torus(40, 20, 1e-3);
    const Result result = decimated(in, {.max_distance_m = 0.01});
    auto at = in.vertices.begin();
    for (const Vector3d& p : result.mesh.vertices) {
        at = std::find(at, in.vertices.end(), p);
        ASSERT_NE(at, in.vertices.end());
        ++at;
    }
}

TEST(Decimate, KeepsTheSmallestAndEmptyMeshes) {
    EXPECT_EQ(decimated(tetrahedron(), {.max_distance_m = 10.0}).mesh.triangles,
              tetrahedron().triangles);
    TriangleMesh pillow;
    pillow.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    pillow.triangles = {{0, 1, 2}, {0, 2, 1}};
    EXPECT_EQ(decimated(pillow, {.max_distance_m = 10.0}).mesh.triangles, pillow.triangles);
    EXPECT_TRUE(decimated({}, {}).mesh.empty());
    const TriangleMesh in = torus(20, 10);
    const Result untouched = decimated(in, {.max_distance_m = 0.0});
    EXPECT_EQ(untouched.mesh.triangles, in.triangles);
    EXPECT_EQ(untouched.report.distance_bound_m, 0.0);
}

TEST(Decimate, RefusesOpenSurfaces) {
    DecimateScratch scratch;
    TriangleMesh out;
    const auto error_after = [&](auto change) {
        TriangleMesh mesh = tetrahedron();
        change(mesh);
        const auto report = decimate(mesh, {}, scratch, out);
        EXPECT_TRUE(out.vertices.empty() && out.empty());
        EXPECT_TRUE(report || report.error().kind == ErrorKind::kInvalidData);
        return report ? std::string("no error") : report.error().message;
    };
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(error_after([](auto& m) { m.triangles.pop_back(); }), HasSubstr("not closed"));
    EXPECT_THAT(error_after([](auto& m) { std::swap(m.triangles[0][0], m.triangles[0][1]); }),
                HasSubstr("not closed"));
    EXPECT_THAT(error_after([](auto& m) { m.triangles.push_back(m.triangles[0]); }),
                HasSubstr("not closed"));
    EXPECT_THAT(error_after([](auto& m) { m.triangles[1][2] = 4; }), HasSubstr("triangle 1"));
    EXPECT_THAT(error_after([](auto& m) { m.triangles[2][1] = m.triangles[2][0]; }),
                HasSubstr("triangle 2"));
    EXPECT_THAT(error_after([](auto& m) { m.vertices[3].y() = kNan; }), HasSubstr("vertex 3"));
    EXPECT_THAT(error_after([](auto& m) { m.vertices[1].x() = 1e200; }), HasSubstr("vertex 1"));
    EXPECT_THAT(error_after([](auto& m) { m.vertices.emplace_back(2, 2, 2); }),
                HasSubstr("vertex 4"));
    // two tetrahedra that share a vertex
    EXPECT_THAT(error_after([](auto& m) {
                    m.vertices.insert(m.vertices.end(), {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
                    const TriangleMesh first = tetrahedron();
                    for (const auto& [a, b, c] : first.triangles) {
                        const auto moved = [](std::uint32_t v) { return v == 0 ? 0 : v + 3; };
                        m.triangles.push_back({moved(a), moved(c), moved(b)});
                    }
                }),
                HasSubstr("vertex 0"));
    for (const double max_m : {-1.0, kNan, std::numeric_limits<double>::infinity()}) {
        const auto report = decimate(tetrahedron(), {.max_distance_m = max_m}, scratch, out);
        ASSERT_FALSE(report);
        EXPECT_EQ(report.error().kind, ErrorKind::kConfiguration);
    }
}

TEST(Decimate, SurvivesSurfacesWithoutArea) {
    for (const int kind : {0, 1, 2}) {
        TriangleMesh in = torus(20, 12, 1e-3);
        for (Vector3d& p : in.vertices) {
            if (kind == 0) p.z() = 0.0;
            if (kind == 1) p = {p.x(), 0.0, 0.0};
            if (kind == 2) p.setConstant(0.25);
        }
        const Result result = decimated(in, {.max_distance_m = 0.01});
        expect_same_topology(in, result.mesh);
        EXPECT_LE(test::SurfaceDistance(result.mesh).largest_m(in, 0), 0.01);
    }
}

TEST(Decimate, RepeatsBitsAndDoesNotAllocateOnceWarm) {
    const TriangleMesh in = torus(40, 20, 1e-3);
    DecimateScratch scratch;
    TriangleMesh out;
    ASSERT_TRUE(decimate(in, {.max_distance_m = 5e-3}, scratch, out));
    const TriangleMesh first = out;
    const std::uint64_t before = test::num_allocations();
    const auto report = decimate(in, {.max_distance_m = 5e-3}, scratch, out);
    EXPECT_EQ(test::num_allocations(), before);
    ASSERT_TRUE(report);
    EXPECT_EQ(out.vertices, first.vertices);
    EXPECT_EQ(out.triangles, first.triangles);
}

// The tip of a pyramid over a regular polygon of radius 1 m moves to one corner of its base.
class PyramidTip : public testing::TestWithParam<int> {};

TEST_P(PyramidTip, MovesByItsHeight) {
    constexpr double kHeight_m = 0.03;
    std::vector<Vector3d> ring;
    for (int i = 0; i < GetParam(); ++i) {
        const double angle = 2.0 * std::numbers::pi * i / GetParam();
        ring.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    }
    std::vector<DisplacementBox> before(ring.size());
    CollapseMap map;
    ASSERT_TRUE(map.bound({0.01, 0.02, kHeight_m}, ring, before, 1.0, 0.0));
    double longest = 0.0;
    for (const DisplacementBox& box : map.after()) longest = std::max(longest, box.longest_m());
    EXPECT_GE(longest, kHeight_m * (1.0 - 1e-12));
    EXPECT_LE(longest, 1.01 * kHeight_m);  // the sideways part is at most the slope
    EXPECT_FALSE(map.bound({0.01, 0.02, kHeight_m}, ring, before, 0.99 * kHeight_m, 0.0));
    // boxes that were 1 cm lower before are now 4 cm lower, and 2 cm instead of 3 cm higher
    for (DisplacementBox& box : before) box.add(Eigen::Array3d(0.0, 0.0, -0.01));
    ASSERT_TRUE(map.bound({0.01, 0.02, kHeight_m}, ring, before, 1.0, 0.0));
    double lowest = 0.0;
    double highest = 0.0;
    for (const DisplacementBox& box : map.after()) {
        lowest = std::min(lowest, box.low.z());
        highest = std::max(highest, box.high.z());
    }
    EXPECT_NEAR(lowest, -0.01 - kHeight_m, 1e-12);
    EXPECT_NEAR(highest, 0.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Sides, PyramidTip, testing::Values(3, 4, 5, 6, 9, 24));

}  // namespace
}  // namespace atrium::geometry
