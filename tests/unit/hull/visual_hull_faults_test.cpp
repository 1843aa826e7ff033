#include "site_node/hull/visual_hull.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/unit/hull/hull_of_a_sphere.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <vector>

// Views without a hull, and views that the hull refuses.
namespace atrium::hull {
namespace {

using test::Contour;

class FaultyViews : public HullOfASphere {};

TEST_F(FaultyViews, GiveAnEmptyHullIfOneCameraSeesNobody) {
    views_[5].contours.clear();
    const VisualHull hull = compute_visual_hull(views_, {}, scratch_);
    EXPECT_EQ(hull.status, HullStatus::kEmptyIntersection);
    EXPECT_TRUE(hull.mesh.empty());
}

TEST_F(FaultyViews, GiveAnEmptyHullIfConesMissEachOther) {
    for (auto& p : views_[2].contours[0]) p.x() += 5000.0;
    EXPECT_EQ(compute_visual_hull(views_, {}, scratch_).status, HullStatus::kEmptyIntersection);
}

TEST_F(FaultyViews, AreTooFewBelowTwo) {
    EXPECT_EQ(compute_visual_hull(std::span(views_).first(1), {}, scratch_).status,
              HullStatus::kTooFewViews);
    EXPECT_EQ(compute_visual_hull({}, {}, scratch_).status, HullStatus::kTooFewViews);
    const std::vector<SilhouetteView> same{views_[0], views_[0]};
    EXPECT_EQ(compute_visual_hull(same, {}, scratch_).status, HullStatus::kTooFewViews);
}

TEST_F(FaultyViews, AreUnboundedIfAllCamerasLookTheSameWay) {
    SilhouetteView beside = views_[0];
    beside.camera_from_site.translation.x() += 0.3;
    const std::vector<SilhouetteView> pair{views_[0], beside};
    EXPECT_EQ(compute_visual_hull(pair, {}, scratch_).status, HullStatus::kUnbounded);
}

TEST_F(FaultyViews, AreRefusedForNonFiniteNumbers) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto status_with = [&](auto change) {
        std::vector<SilhouetteView> views = views_;
        change(views[1]);
        return compute_visual_hull(views, {}, scratch_).status;
    };
    using View = SilhouetteView;
    EXPECT_EQ(status_with([&](View& v) { v.contours[0][7].x() = kNan; }),
              HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.contours[0][7].y() = kInfinity; }),
              HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.contours[0][7].y() = 1e300; }),
              HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.intrinsics.fx = 0.0; }), HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.intrinsics.cy = kNan; }), HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.camera_from_site.translation.z() = kInfinity; }),
              HullStatus::kInvalidInput);
    EXPECT_EQ(status_with([&](View& v) { v.camera_from_site.rotation.coeffs().setZero(); }),
              HullStatus::kInvalidInput);
}

TEST_F(FaultyViews, AreRefusedAboveTheMaximumNumber) {
    const std::vector<SilhouetteView> views(kMaxViews + 1, views_[0]);
    EXPECT_EQ(compute_visual_hull(views, {}, scratch_).status, HullStatus::kInvalidInput);
}

TEST_F(FaultyViews, AreRefusedForTooMuchWork) {
    HullOptions options;
    options.max_segments = 100;
    EXPECT_EQ(compute_visual_hull(views_, options, scratch_).status, HullStatus::kTooComplex);
}

TEST(HullOfCombs, StopsAfterTheAllowedSteps) {
    // twelve crossing combs: many crossings on every strip
    std::vector<SilhouetteView> views;
    for (const auto& camera : test::make_ring_rig({.num_cameras = 12})) {
        Contour comb;
        for (int i = 0; i < 120; ++i)
            comb.emplace_back(i % 2 == 0 ? 200.0 : 800.0, 200.0 + 4.0 * i);
        for (int i = 119; i >= 0; --i)
            comb.emplace_back(i % 2 == 0 ? 202.0 : 802.0, 202.0 + 4.0 * i);
        views.push_back(test::make_view(camera, {comb}));
    }
    HullOptions options;
    options.max_steps = 1000;
    HullScratch scratch;
    EXPECT_EQ(compute_visual_hull(views, options, scratch).status, HullStatus::kTooComplex);
}

TEST(HullOfCombs, StopsForManyLinesWithoutCrossings) {
    // Two cameras above each other. The long sides of slivers in one picture run along the epipolar
    // lines of the other and meet every tooth of its comb.
    Contour comb;
    for (int i = 0; i < 6000; ++i) {
        const double y = 100.0 + 800.0 * i / 6000;
        comb.emplace_back(600.0 + (7919 * i % 1000) * 0.1, y);
        comb.emplace_back(300.0 + (104729 * i % 1000) * 0.1, y + 0.07);
    }
    comb.emplace_back(200.0, 900.5);
    comb.emplace_back(200.0, 99.5);
    std::vector<Contour> slivers;
    for (int i = 0; i < 600; ++i) {
        const double y = 100.0 + 800.0 * i / 600;
        slivers.push_back({{250.0, y}, {750.0, y + 0.3}, {750.5, y + 0.6}});
    }
    geometry::CalibratedCamera upper;
    upper.intrinsics = {
        .width = 1000, .height = 1000, .fx = 1000, .fy = 1000, .cx = 500, .cy = 500};
    upper.camera_from_site = test::look_at({0.0, -3.0, 1.5}, {0.0, 0.0, 1.5});
    geometry::CalibratedCamera lower = upper;
    lower.camera_from_site = test::look_at({0.0, -3.0, 1.0}, {0.0, 0.0, 1.0});
    const std::vector<SilhouetteView> views{test::make_view(upper, slivers),
                                            test::make_view(lower, {comb})};
    HullOptions options;
    options.bounds = geometry::Aabb{{-3.0, -2.5, -3.0}, {3.0, 5.0, 5.0}};
    HullScratch scratch;
    EXPECT_EQ(compute_visual_hull(views, options, scratch).status, HullStatus::kTooComplex);
}

// A bar of cameras along an axis of the site. The same row of two pictures is one plane.
TEST(RectifiedRig, NeedsOneAttempt) {
    for (const int radius_px : {50, 200}) {
        std::vector<SilhouetteView> views;
        for (int i = -2; i <= 2; ++i) {
            geometry::CalibratedCamera camera;
            camera.intrinsics = {
                .width = 1000, .height = 1000, .fx = 1000, .fy = 1000, .cx = 499.5, .cy = 499.5};
            const double x_m = 0.3 * i;
            camera.camera_from_site = test::look_at({x_m, -3.0, 1.0}, {x_m, 0.0, 1.0});
            // a disc, cut along the pixels
            Contour left, right;
            for (int y = -radius_px; y < radius_px; ++y) {
                const double half =
                    std::round(std::sqrt(radius_px * radius_px - (y + 0.5) * (y + 0.5)));
                const double centre = 499.5 - 1000.0 * x_m / 3.0;
                for (const int end : {y, y + 1}) {
                    left.emplace_back(std::round(centre - half) - 0.5, 499.5 + end);
                    right.emplace_back(std::round(centre + half) + 0.5, 499.5 + end);
                }
            }
            left.insert(left.end(), right.rbegin(), right.rend());
            views.push_back(test::make_view(camera, {left}));
        }
        HullOptions options;
        options.bounds = geometry::Aabb{{-1.0, -1.0, 0.0}, {1.0, 1.0, 2.0}};
        HullScratch scratch;
        const VisualHull hull = compute_visual_hull(views, options, scratch);
        EXPECT_EQ(hull.status, HullStatus::kOk);
        EXPECT_EQ(hull.num_attempts, 1u);
        EXPECT_TRUE(geometry::inspect(hull.mesh).manifold);
    }
}

TEST_F(FaultyViews, LoseContoursWithoutArea) {
    const VisualHull clean = compute_visual_hull(views_, {}, scratch_);
    views_[0].contours.push_back({{10.0, 10.0}, {20.0, 10.0}, {30.0, 10.0}});
    views_[1].contours.push_back({{10.0, 10.0}});
    views_[2].contours.emplace_back();
    const VisualHull hull = compute_visual_hull(views_, {}, scratch_);
    EXPECT_EQ(hull.num_contours_dropped, 3u);
    EXPECT_EQ(clean.mesh.vertices, hull.mesh.vertices);
}

}  // namespace
}  // namespace atrium::hull
