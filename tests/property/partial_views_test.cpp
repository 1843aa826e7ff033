#include "site_node/hull/visual_hull.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/polygons.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/support/shapes/winding_number.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

// Compares hulls of cameras that see only a part of space with the definition, point by point.
namespace atrium::hull {
namespace {

using test::between;
using test::Contour;
using test::Random;

struct Scene {
    std::vector<SilhouetteView> views;
    HullOptions options;
};

// Cameras around a box, with unrelated silhouettes. Most have a field that cuts their silhouette,
// some a field without any silhouette, some none.
Scene random_scene(std::uint64_t seed) {
    Random random(seed);
    Scene scene;
    const int num_views = between(random, 2, 7);
    for (int i = 0; i < num_views; ++i) {
        const Eigen::Vector3d direction = test::random_direction(random);
        const Eigen::Vector3d centre = between(random, 1.2, 3.0) * direction;
        geometry::CalibratedCamera camera;
        camera.intrinsics = {1000, 1000, 1000.0, 1050.0, 499.5, 480.5};
        camera.camera_from_site = test::look_at(centre, test::random_in_cube(random, 0.2));
        const Eigen::Vector2d middle(between(random, 350.0, 650.0), between(random, 350.0, 650.0));
        std::vector<Contour> contours;
        const int kind = between(random, 0, 7);
        if (kind != 0) {
            contours.push_back(test::random_star(
                random, middle, between(random, 100.0, 450.0), between(random, 3, 24)));
        }
        if (kind > 4) contours.push_back(test::random_star(random, middle, 40.0, 5));
        SilhouetteView view = test::make_view(camera, contours);
        const int field = between(random, 0, 4);
        if (field == 1) {
            view.field = {{2.0, 2.0}, {997.0, 2.0}, {997.0, 997.0}, {2.0, 997.0}};
            // a camera that sees no subject anywhere empties the hull
        } else if (field > 1 || kind == 0) {
            const double left = between(random, 100.0, 500.0);
            const double top = between(random, 100.0, 500.0);
            const double right = left + between(random, 150.0, 500.0);
            const double bottom = top + between(random, 150.0, 500.0);
            view.field = {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
            if (field == 4) view.field.emplace_back(0.6 * left + 0.4 * right, 0.5 * (top + bottom));
        }
        scene.views.push_back(view);
    }
    geometry::Aabb bounds;
    bounds.add({between(random, -0.8, -0.3), between(random, -0.8, -0.3), -0.6});
    bounds.add({between(random, 0.3, 0.8), between(random, 0.3, 0.8), 0.5});
    scene.options.bounds = bounds;
    scene.options.min_views = static_cast<std::uint32_t>(between(random, 0, num_views));
    scene.options.keep_phantoms = true;
    return scene;
}

struct Truth {
    bool inside = false;
    bool is_clear = false;  // far enough from every border to make the jitter irrelevant
};

Truth truth_of(const Eigen::Vector3d& p, const Scene& scene) {
    constexpr double kMargin_px = 0.01;
    constexpr double kMargin_m = 1e-5;
    const geometry::Aabb& bounds = *scene.options.bounds;
    Truth truth{bounds.contains(p), true};
    truth.is_clear = (p - bounds.min).cwiseAbs().minCoeff() > kMargin_m &&
                     (p - bounds.max).cwiseAbs().minCoeff() > kMargin_m;
    std::uint32_t num_seeing = 0;
    for (const SilhouetteView& view : scene.views) {
        const Eigen::Vector3d p_camera = view.camera_from_site * p;
        if (std::abs(p_camera.z()) < kMargin_m) truth.is_clear = false;
        if (p_camera.z() <= 0.0) {
            truth.inside &= !view.field.empty();
            continue;
        }
        const Eigen::Vector2d px = view.intrinsics.project(p_camera);
        const std::vector<Contour> field{view.field};
        truth.is_clear &= test::distance_to_edges(view.contours, px) > kMargin_px;
        if (!view.field.empty()) truth.is_clear &= test::distance_to_edges(field, px) > kMargin_px;
        const bool in_field = view.field.empty() || test::even_odd(field, px);
        const bool in_silhouette = test::even_odd(view.contours, px);
        if (in_field && !in_silhouette) truth.inside = false;
        num_seeing += in_field && in_silhouette ? 1 : 0;
    }
    truth.inside &= num_seeing >= scene.options.min_views;
    return truth;
}

class PartialViews : public testing::TestWithParam<int> {
protected:
    void SetUp() override { scene_ = random_scene(static_cast<std::uint64_t>(GetParam())); }
    VisualHull compute() { return compute_visual_hull(scene_.views, scene_.options, scratch_); }
    // Points inside the bounds, on faces and near them.
    Eigen::Vector3d random_point(Random& random, const VisualHull& hull) {
        const geometry::Aabb& box = *scene_.options.bounds;
        Eigen::Vector3d p;
        for (int c = 0; c < 3; ++c) p[c] = between(random, box.min[c] - 0.05, box.max[c] + 0.05);
        if (hull.mesh.empty() || between(random, 0, 1) == 0) return p;
        const auto& t = hull.mesh.triangles[static_cast<std::size_t>(
            between(random, 0, static_cast<int>(hull.mesh.triangles.size()) - 1))];
        const auto& v = hull.mesh.vertices;
        p = (v[t[0]] + v[t[1]] + v[t[2]]) / 3.0;
        for (int c = 0; c < 3; ++c) p[c] += between(random, -0.005, 0.005);
        return p;
    }
    Scene scene_;
    HullScratch scratch_;
};

TEST_P(PartialViews, ContainExactlyTheUncarvedSpaceThatEnoughSee) {
    const VisualHull hull = compute();
    ASSERT_TRUE(hull.status == HullStatus::kOk || hull.status == HullStatus::kEmptyIntersection)
        << to_string(hull.status);
    const geometry::MeshReport report = geometry::inspect(hull.mesh);
    if (hull.status == HullStatus::kOk) {
        EXPECT_TRUE(report.closed);
        EXPECT_TRUE(report.manifold);
        EXPECT_GT(report.volume_m3, 0.0);
    }
    Random random(4711);
    for (int i = 0; i < 400; ++i) {
        const Eigen::Vector3d p = random_point(random, hull);
        const Truth truth = truth_of(p, scene_);
        if (!truth.is_clear) continue;
        const double winding = hull.mesh.empty() ? 0.0 : test::winding_number(hull.mesh, p);
        EXPECT_NEAR(winding, truth.inside ? 1.0 : 0.0, 1e-3) << p.transpose();
    }
}

TEST_P(PartialViews, DoNotDependOnTheOrderOfViewsOrTheFilter) {
    const VisualHull hull = compute();
    Random random(7);
    std::shuffle(scene_.views.begin(), scene_.views.end(), random);
    const VisualHull shuffled = compute();
    EXPECT_EQ(hull.mesh.vertices, shuffled.mesh.vertices);
    EXPECT_EQ(hull.mesh.triangles, shuffled.mesh.triangles);
    scene_.options.only_exact = true;
    const VisualHull exact = compute();
    EXPECT_EQ(hull.mesh.vertices, exact.mesh.vertices);
    EXPECT_EQ(hull.mesh.triangles, exact.mesh.triangles);
}

TEST_P(PartialViews, ShrinkIfMoreViewsAreRequired) {
    scene_.options.min_views = 0;
    double last = 1e9;
    for (std::uint32_t m = 0; m <= scene_.views.size() + 1; ++m) {
        scene_.options.min_views = m;
        const VisualHull hull = compute();
        ASSERT_TRUE(hull.status == HullStatus::kOk || hull.status == HullStatus::kEmptyIntersection)
            << to_string(hull.status);
        const double volume = geometry::volume_m3(hull.mesh);
        EXPECT_LE(volume, last + 1e-7);
        last = volume;
    }
    EXPECT_EQ(last, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PartialViews, testing::Range(0, 300));

}  // namespace
}  // namespace atrium::hull
