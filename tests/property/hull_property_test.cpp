#include "site_node/hull/visual_hull.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/hull_checks.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/support/shapes/winding_number.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>

namespace atrium::hull {
namespace {

using test::between;
using test::Contour;
using test::Random;

// Cameras anywhere on a sphere, including opposite ones, with stars as silhouettes. They have many
// more corner cases than real silhouettes.
std::vector<SilhouetteView> unrelated_views(std::uint64_t seed) {
    Random random(seed);
    std::vector<SilhouetteView> views;
    const int num_views = between(random, 3, 9);
    Eigen::Vector3d last_centre(3.0, 0.0, 0.0);
    for (int i = 0; i < num_views; ++i) {
        Eigen::Vector3d centre = 3.0 * test::random_direction(random);
        if (i % 3 == 2) centre = -last_centre * between(random, 0.8, 1.2);
        last_centre = centre;
        geometry::CalibratedCamera camera;
        camera.intrinsics = {1000, 1000, 1300.0, 1250.0, 499.5, 480.5, 2.0};
        camera.camera_from_site = test::look_at(centre, test::random_in_cube(random, 0.1));
        views.push_back(test::make_view(camera, test::random_stars(random, 30)));
    }
    return views;
}

class RandomScene : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        views_ = unrelated_views(static_cast<std::uint64_t>(GetParam()));
        hull_ = test::exact_hull_of(views_);
        // the cones of all these seeds have a common point
        ASSERT_EQ(hull_.status, HullStatus::kOk) << to_string(hull_.status);
    }
    // A camera that all others see inside their silhouettes is a vertex with as many faces as its
    // outline has edges.
    bool has_camera_centre() const {
        return std::any_of(views_.begin(), views_.end(), [&](const SilhouetteView& view) {
            const Eigen::Vector3d centre = view.camera_from_site.inverse().translation;
            return std::any_of(hull_.mesh.vertices.begin(),
                               hull_.mesh.vertices.end(),
                               [&](const auto& p) { return (p - centre).norm() < 1e-9; });
        });
    }
    std::vector<SilhouetteView> views_;
    VisualHull hull_;
};

TEST_P(RandomScene, HasAClosedManifoldHullInGeneralPosition) {
    if (has_camera_centre()) {
        test::expect_closed(hull_);
    } else {
        test::expect_sound(hull_);
    }
    EXPECT_EQ(hull_.num_attempts, 1u);
}

TEST_P(RandomScene, ContainsExactlyThePointsInAllSilhouettes) {
    // a point well inside or outside all outlines: the mesh must agree with the pictures
    constexpr double kMargin_px = 0.01;
    Random random(99);
    const geometry::Aabb box = geometry::bounds(hull_.mesh);
    int num_inside = 0;
    for (int i = 0; i < 300; ++i) {
        Eigen::Vector3d p;
        if (i % 2 == 0) {
            for (int c = 0; c < 3; ++c)
                p[c] = between(random, box.min[c] - 0.05, box.max[c] + 0.05);
        } else {  // near the surface
            const auto& t = hull_.mesh.triangles[static_cast<std::size_t>(
                between(random, 0, static_cast<int>(hull_.mesh.triangles.size()) - 1))];
            p = (hull_.mesh.vertices[t[0]] + hull_.mesh.vertices[t[1]] +
                 hull_.mesh.vertices[t[2]]) /
                3.0;
            for (int c = 0; c < 3; ++c) p[c] += between(random, -0.01, 0.01);
        }
        const test::Membership truth = test::membership(p, views_);
        if (truth.margin_px < kMargin_px) continue;
        num_inside += truth.inside ? 1 : 0;
        EXPECT_NEAR(test::winding_number(hull_.mesh, p), truth.inside ? 1.0 : 0.0, 1e-3)
            << p.transpose();
    }
    EXPECT_GT(num_inside, 0);
}

TEST_P(RandomScene, DoesNotDependOnAnyOrder) {
    Random random(7);
    std::vector<SilhouetteView> shuffled = views_;
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    for (SilhouetteView& view : shuffled) {
        std::shuffle(view.contours.begin(), view.contours.end(), random);
        for (Contour& contour : view.contours) {
            std::rotate(contour.begin(),
                        contour.begin() + between(random, 0, static_cast<int>(contour.size()) - 1),
                        contour.end());
            if (between(random, 0, 1) == 0) std::reverse(contour.begin(), contour.end());
        }
    }
    const VisualHull again = test::exact_hull_of(shuffled);
    EXPECT_EQ(hull_.mesh.vertices, again.mesh.vertices);
    EXPECT_EQ(hull_.mesh.triangles, again.mesh.triangles);
}

// The filter in front of the exact decisions may change only the speed.
TEST_P(RandomScene, IsTheSameWithIntegerDecisionsOnly) {
    HullOptions options;
    options.keep_phantoms = true;
    options.only_exact = true;
    HullScratch scratch;
    const VisualHull exact = compute_visual_hull(views_, options, scratch);
    EXPECT_EQ(hull_.mesh.vertices, exact.mesh.vertices);
    EXPECT_EQ(hull_.mesh.triangles, exact.mesh.triangles);
}

TEST_P(RandomScene, MovesWithTheRig) {
    const geometry::RigidTransform moved_from_site{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized())),
        {1.0, -3.0, 2.0}};
    std::vector<SilhouetteView> moved = views_;
    for (SilhouetteView& view : moved)
        view.camera_from_site = view.camera_from_site * moved_from_site.inverse();
    const VisualHull hull = test::exact_hull_of(moved);
    ASSERT_EQ(hull.status, HullStatus::kOk);
    EXPECT_EQ(hull.mesh.vertices.size(), hull_.mesh.vertices.size());
    // another pose has another jitter: the surface may move by what 1e-6 px are at 4 m
    double area_m2 = 0.0;
    for (const auto& [a, b, c] : hull_.mesh.triangles) {
        const auto& p = hull_.mesh.vertices;
        area_m2 += 0.5 * (p[b] - p[a]).cross(p[c] - p[a]).norm();
    }
    EXPECT_NEAR(geometry::volume_m3(hull.mesh), geometry::volume_m3(hull_.mesh), 4e-9 * area_m2);
}

TEST_P(RandomScene, ShrinksWithOneMoreCamera) {
    std::vector<SilhouetteView> more = views_;
    const auto extra = unrelated_views(static_cast<std::uint64_t>(GetParam()) + 1000);
    more.push_back(extra.front());
    const VisualHull smaller = test::exact_hull_of(more);
    ASSERT_EQ(smaller.status, HullStatus::kOk) << to_string(smaller.status);
    const double volume = geometry::volume_m3(hull_.mesh);
    EXPECT_LE(geometry::volume_m3(smaller.mesh), volume * (1.0 + 1e-8));
    for (std::size_t v = 0; v < smaller.mesh.vertices.size(); v += 7) {
        const test::Membership in_old = test::membership(smaller.mesh.vertices[v], views_);
        EXPECT_TRUE(in_old.inside || in_old.margin_px < 1e-4);
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomScene, testing::Range(0, 60));

// Input that no camera delivers. Any status is fine, but kOk requires a sound mesh, and the result
// must come soon.
class HostileScene : public testing::TestWithParam<int> {};

Contour hostile_contour(Random& random) {
    Contour contour;
    const int kind = between(random, 0, 5);
    const int n = between(random, 0, 40);
    for (int i = 0; i < n; ++i) {
        Eigen::Vector2d p(between(random, 300.0, 700.0), between(random, 300.0, 700.0));
        if (kind == 0)
            p = {std::round(p.x() / 50.0) * 50.0,
                 std::round(p.y() / 50.0) * 50.0};                    // touches itself
        if (kind == 1) p.y() = 500.0;                                 // no area
        if (kind == 2) p *= between(random, 0, 30) == 0 ? 1e4 : 1.0;  // far outside
        if (kind == 3 && i > 0) p = contour.back() + 1e-7 * p;        // tiny
        contour.push_back(p);
    }
    if (kind == 4 && n > 0) contour[0].x() = std::numeric_limits<double>::quiet_NaN();
    if (kind == 5) contour = test::regular_polygon({500.0, 500.0}, 150.0, 4, 0.0);
    return contour;
}

TEST_P(HostileScene, GivesAStatusOrASoundMesh) {
    Random random(static_cast<std::uint64_t>(GetParam()));
    // exactly symmetric poses: as degenerate as rigs can be
    const auto rig =
        test::make_ring_rig({.num_cameras = between(random, 2, 6), .heights_m = {0.9}});
    std::vector<SilhouetteView> views;
    for (const auto& camera : rig) {
        std::vector<Contour> contours;
        for (int c = between(random, 1, 4); c > 0; --c) contours.push_back(hostile_contour(random));
        if (between(random, 0, 1) == 0)
            contours = {test::regular_polygon({499.5, 499.5}, 150.0, 8, 0.0)};
        views.push_back(test::make_view(camera, contours));
    }
    HullScratch scratch;
    for (const bool keep : {false, true}) {
        HullOptions options;
        options.keep_phantoms = keep;
        const VisualHull hull = compute_visual_hull(views, options, scratch);
        const geometry::MeshReport report = geometry::inspect(hull.mesh);
        EXPECT_EQ(hull.status == HullStatus::kOk, report.closed && report.manifold);
        EXPECT_EQ(hull.status != HullStatus::kOk, hull.mesh.empty());
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, HostileScene, testing::Range(0, 150));

}  // namespace
}  // namespace atrium::hull
