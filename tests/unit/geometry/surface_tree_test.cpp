#include "core/geometry/surface_tree.hpp"

#include "tests/support/shapes/box_mesh.hpp"
#include "tests/support/shapes/closed_meshes.hpp"
#include "tests/support/shapes/surface_distance.hpp"
#include "tests/support/shapes/winding_number.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace atrium::geometry {
namespace {

using Eigen::Vector3d;

TriangleMesh cube(const Vector3d& centre, double size_m) {
    const Vector3d size = Vector3d::Constant(size_m);
    return test::box_mesh(centre - 0.5 * size, size);
}

template <class Check>
void at_random_points(double reach_m, int num_points, const Check& check) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> along(-reach_m, reach_m);
    for (int i = 0; i < num_points; ++i)
        check(Vector3d(along(random), along(random), along(random)));
}

TEST(SurfaceTree, TellsInsideAndDepthOfACube) {
    const SurfaceTree tree(cube({0, 0, 0}, 1.0));
    EXPECT_NEAR(tree.winding_number({0, 0, 0}), 1.0, 1e-9);
    EXPECT_NEAR(tree.winding_number({0, 0, 0.6}), 0.0, 0.05);
    EXPECT_NEAR(tree.depth_m({0, 0, 0}), 0.5, 1e-12);
    EXPECT_NEAR(tree.depth_m({0.45, 0, 0.1}), 0.05, 1e-12);
    EXPECT_EQ(tree.depth_m({0.45, 0, 0.6}), 0.0);
    EXPECT_NEAR(tree.distance_m({0.5 + 0.3, 0.5 + 0.4, 0}), 0.5, 1e-12) << "to an edge";
    EXPECT_NEAR(tree.distance_m({-0.7, 0, 0}), 0.2, 1e-12) << "to a face";
    EXPECT_NEAR(tree.distance_m({1.5, 1.5, 1.5}), std::sqrt(3.0), 1e-12) << "to a corner";
}

TEST(SurfaceTree, AgreesWithTheAnswerForASphere) {
    constexpr double kRadius_m = 1.0;
    constexpr double kFlat_m = 2e-3;  // the triangles are below the sphere
    const SurfaceTree tree(test::make_sphere(5, kRadius_m));
    at_random_points(1.5, 2000, [&](const Vector3d& p) {
        const double inside_m = kRadius_m - p.norm();
        EXPECT_NEAR(tree.distance_m(p), std::abs(inside_m), kFlat_m) << p.transpose();
        if (std::abs(inside_m) < kFlat_m) return;
        EXPECT_NEAR(tree.winding_number(p), inside_m > 0.0 ? 1.0 : 0.0, 0.05) << p.transpose();
        EXPECT_NEAR(tree.depth_m(p), std::max(inside_m, 0.0), kFlat_m) << p.transpose();
    });
}

TEST(SurfaceTree, AgreesWithTheSumOverAllTriangles) {
    TriangleMesh open = test::make_torus(40, 20);
    open.triangles.resize(open.triangles.size() * 2 / 3);
    const SurfaceTree tree(open);
    const test::SurfaceDistance distance(open);
    at_random_points(1.2, 500, [&](const Vector3d& p) {
        EXPECT_NEAR(tree.winding_number(p), test::winding_number(open, p), 0.05) << p.transpose();
        EXPECT_NEAR(tree.distance_m(p), distance.distance_m(p), 1e-12) << p.transpose();
    });
}

TEST(SurfaceTree, AddsUpNestedAndSeparateParts) {
    TriangleMesh shell = cube({0, 0, 0}, 1.0);
    TriangleMesh hollow = cube({0, 0, 0}, 0.6);
    for (auto& triangle : hollow.triangles) std::swap(triangle[0], triangle[1]);
    EXPECT_NEAR(SurfaceTree(hollow).winding_number({0, 0, 0}), -1.0, 1e-9);
    EXPECT_EQ(SurfaceTree(hollow).depth_m({0, 0, 0}), 0.0);
    geometry::append(shell, hollow);
    geometry::append(shell, cube({3, 0, 0}, 1.0));
    const SurfaceTree tree(shell);
    EXPECT_EQ(tree.depth_m({0, 0, 0}), 0.0) << "in the hollow";
    EXPECT_NEAR(tree.depth_m({0.4, 0, 0}), 0.1, 1e-12) << "in its wall";
    EXPECT_NEAR(tree.depth_m({3, 0, 0}), 0.5, 1e-12);
    EXPECT_EQ(tree.depth_m({1.5, 0, 0}), 0.0);
}

TEST(SurfaceTree, GivesFractionsForASheet) {
    TriangleMesh sheet;
    sheet.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    const SurfaceTree tree(sheet);
    const double below = tree.winding_number({0, 0, -1});
    EXPECT_NEAR(below, 1.0 / 6.0, 1e-9) << "as a face of a cube from its centre";
    EXPECT_NEAR(tree.winding_number({0, 0, 1}), -below, 1e-9);
}

TEST(SurfaceTree, MayBeEmptyOrWithoutArea) {
    const SurfaceTree none{TriangleMesh()};
    EXPECT_TRUE(none.empty());
    EXPECT_EQ(none.winding_number({0, 0, 0}), 0.0);
    EXPECT_EQ(none.depth_m({0, 0, 0}), 0.0);
    EXPECT_EQ(none.distance_m({0, 0, 0}), std::numeric_limits<double>::infinity());
    TriangleMesh needle;
    needle.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    needle.triangles = {{0, 1, 2}};
    const SurfaceTree thin(needle);
    EXPECT_EQ(thin.winding_number({1, 1, 0}), 0.0);
    EXPECT_NEAR(thin.distance_m({1, 1, 0}), 1.0, 1e-12);
}

}  // namespace
}  // namespace atrium::geometry
