#include "site_node/hull/corner_rounding.hpp"

#include "tests/support/allocation_counter.hpp"
#include "tests/support/shapes/hull_checks.hpp"
#include "tests/support/shapes/scene_maker.hpp"
#include "tests/unit/hull/hull_of_a_sphere.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace atrium::hull {
namespace {

std::vector<const SilhouetteView*> pointers_to(const std::vector<SilhouetteView>& views) {
    std::vector<const SilhouetteView*> pointers;
    for (const SilhouetteView& view : views) pointers.push_back(&view);
    return pointers;
}

Eigen::Vector2d project(const SilhouetteView& view, const Eigen::Vector3d& site) {
    const Eigen::Vector3d p =
        view.camera_from_site.rotation * site + view.camera_from_site.translation;
    const geometry::PinholeCamera& lens = view.intrinsics;
    const Eigen::Vector2d ideal = p.head<2>() / p.z();
    return {lens.fx * ideal.x() + lens.skew * ideal.y() + lens.cx, lens.fy * ideal.y() + lens.cy};
}

// Largest distance of a vertex from the inside of a silhouette [px].
double farthest_outside_px(const geometry::TriangleMesh& mesh,
                           const std::vector<SilhouetteView>& views) {
    double farthest = 0.0;
    for (const SilhouetteView& view : views) {
        for (const Eigen::Vector3d& vertex : mesh.vertices) {
            const Eigen::Vector2d at = project(view, vertex);
            if (!test::even_odd(view.contours, at))
                farthest = std::max(farthest, test::distance_to_edges(view.contours, at));
        }
    }
    return farthest;
}

TEST_F(HullOfASphere, RoundedIsNearerToTheSphere) {
    const Eigen::Vector3d centre(0.0, 0.1, 0.9);
    const double sphere_m3 = 4.0 / 3.0 * std::numbers::pi * std::pow(0.4, 3);
    const VisualHull hull = compute_visual_hull(views_, {}, scratch_);
    geometry::TriangleMesh rounded = hull.mesh;
    ASSERT_TRUE(CornerRounding().round(rounded, pointers_to(views_)));

    const auto farthest_m = [&](const geometry::TriangleMesh& mesh) {
        double farthest = 0.0;
        for (const Eigen::Vector3d& vertex : mesh.vertices)
            farthest = std::max(farthest, (vertex - centre).norm() - 0.4);
        return farthest;
    };
    const double excess_m3 = geometry::volume_m3(hull.mesh) - sphere_m3;
    const double left_m3 = geometry::volume_m3(rounded) - sphere_m3;
    EXPECT_LT(std::abs(left_m3), 0.5 * excess_m3);
    EXPECT_LT(farthest_m(rounded), 0.75 * farthest_m(hull.mesh));
    // the middle of a viewing edge is where the sphere touches it, or next to it
    for (const Eigen::Vector3d& vertex : rounded.vertices)
        EXPECT_GT((vertex - centre).norm(), 0.4 - 0.01);
}

TEST_F(HullOfASphere, RoundedHasTheSameSilhouettes) {
    const geometry::TriangleMesh hull = compute_visual_hull(views_, {}, scratch_).mesh;
    geometry::TriangleMesh mesh = hull;
    ASSERT_TRUE(CornerRounding().round(mesh, pointers_to(views_)));
    EXPECT_LT(farthest_outside_px(mesh, views_), 0.01);
    const auto reaches = [](const geometry::TriangleMesh& of,
                            const SilhouetteView& view,
                            const Eigen::Vector2d& corner_px) {
        return std::ranges::any_of(of.vertices, [&](const Eigen::Vector3d& vertex) {
            return (project(view, vertex) - corner_px).norm() < 0.01;
        });
    };
    int num_reached = 0;
    for (const SilhouetteView& view : views_) {
        for (const Eigen::Vector2d& corner : view.contours.front()) {
            if (!reaches(hull, view, corner)) continue;  // other cameras cut it away
            ++num_reached;
            EXPECT_TRUE(reaches(mesh, view, corner));
        }
    }
    EXPECT_GT(num_reached, 200);
}

TEST_F(HullOfASphere, RoundingLeavesTheBoundsAlone) {
    HullOptions options;
    options.bounds = geometry::Aabb{{-2.0, -2.0, 0.8}, {2.0, 2.0, 3.0}};
    geometry::TriangleMesh mesh = compute_visual_hull(views_, options, scratch_).mesh;
    const auto on_bounds = [](const geometry::TriangleMesh& of) {
        return std::ranges::count_if(
            of.vertices, [](const Eigen::Vector3d& v) { return std::abs(v.z() - 0.8) < 1e-6; });
    };
    const auto before = on_bounds(mesh);
    ASSERT_GT(before, 10);
    ASSERT_TRUE(CornerRounding().round(mesh, pointers_to(views_)));
    EXPECT_EQ(on_bounds(mesh), before);
}

TEST_F(HullOfASphere, RoundingRefusesOpenMeshes) {
    geometry::TriangleMesh mesh = compute_visual_hull(views_, {}, scratch_).mesh;
    mesh.triangles.pop_back();
    const geometry::TriangleMesh before = mesh;
    EXPECT_FALSE(CornerRounding().round(mesh, pointers_to(views_)));
    EXPECT_EQ(mesh.vertices, before.vertices);
    EXPECT_EQ(mesh.triangles, before.triangles);
    mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.vertices.size())});
    EXPECT_FALSE(CornerRounding().round(mesh, pointers_to(views_)));
}

TEST(CornerRounding, LeavesAnEmptyMeshEmpty) {
    geometry::TriangleMesh mesh;
    CornerRounding().round(mesh, {});
    EXPECT_TRUE(mesh.empty());
}

TEST(CornerRounding, KeepsAMeshThatNoCameraMade) {
    const auto views = test::make_scene({}, 5);
    geometry::TriangleMesh mesh = test::exact_hull_of(views).mesh;
    const geometry::TriangleMesh before = mesh;
    SilhouetteView elsewhere = views.front();
    elsewhere.camera_from_site.translation += Eigen::Vector3d(0.123, 0.567, 0.9);
    const std::vector<SilhouetteView> strangers{elsewhere};
    ASSERT_TRUE(CornerRounding().round(mesh, pointers_to(strangers)));
    EXPECT_EQ(mesh.vertices, before.vertices);
    EXPECT_EQ(mesh.triangles, before.triangles);
}

// People, balls, boxes, rods, rings of cameras and unusual rigs, with noise and without.
TEST(CornerRounding, KeepsHullsClosedAndInside) {
    CornerRounding rounding;
    std::size_t num_rounded = 0;
    for (std::uint64_t seed = 1; seed <= 120; ++seed) {
        const test::SceneOptions options = test::random_scene_options(seed);
        SCOPED_TRACE(test::describe(options, seed));
        const auto views = test::make_scene(options, seed);
        const VisualHull hull = test::exact_hull_of(views);
        if (hull.status != HullStatus::kOk) continue;
        geometry::TriangleMesh mesh = hull.mesh;
        ASSERT_TRUE(rounding.round(mesh, pointers_to(views)));
        const geometry::MeshReport before = geometry::inspect(hull.mesh);
        const geometry::MeshReport after = geometry::inspect(mesh);
        EXPECT_TRUE(after.closed);
        EXPECT_TRUE(after.manifold);
        EXPECT_EQ(after.num_components, before.num_components);
        EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
        EXPECT_LE(after.volume_m3, before.volume_m3 * (1.0 + 1e-9));
        EXPECT_GT(after.volume_m3, 0.5 * before.volume_m3);
        // repairs of crossing outlines leave some vertices outside of the hull itself
        EXPECT_LT(farthest_outside_px(mesh, views), 0.05 + farthest_outside_px(hull.mesh, views));
        EXPECT_LT(mesh.triangles.size(), 2 * hull.mesh.triangles.size());
        num_rounded += mesh.triangles.size() > hull.mesh.triangles.size() ? 1 : 0;
    }
    EXPECT_GT(num_rounded, 60U);
}

TEST_F(HullOfASphere, RoundingStopsAllocating) {
    const geometry::TriangleMesh hull = compute_visual_hull(views_, {}, scratch_).mesh;
    CornerRounding rounding;
    geometry::TriangleMesh mesh;
    const auto views = pointers_to(views_);
    std::uint64_t before = 0;
    for (int turn = 0; turn < 3; ++turn) {
        mesh.vertices.assign(hull.vertices.begin(), hull.vertices.end());
        mesh.triangles.assign(hull.triangles.begin(), hull.triangles.end());
        before = test::num_allocations();
        rounding.round(mesh, views);
    }
    EXPECT_EQ(test::num_allocations(), before);
}

}  // namespace
}  // namespace atrium::hull
