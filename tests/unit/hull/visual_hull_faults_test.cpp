#include "site_node/hull/visual_hull.hpp"
#include "tests/support/rig_maker.hpp"
#include "tests/support/silhouette_maker.hpp"
#include "tests/unit/hull/hull_of_a_sphere.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <span>
#include <vector>

// What has no hull, and what is refused.
namespace atrium::hull {
namespace {

using test::Contour;

class FaultyViews : public HullOfASphere {};

TEST_F(FaultyViews, IsEmptyWhereOneCameraSeesNobody) {
    views_[5].contours.clear();
    const VisualHull hull = compute_visual_hull(views_, {}, scratch_);
    EXPECT_EQ(hull.status, HullStatus::kEmptyIntersection);
    EXPECT_TRUE(hull.mesh.empty());
}

TEST_F(FaultyViews, IsEmptyWhereConesMissEachOther) {
    for (auto& p : views_[2].contours[0]) p.x() += 5000.0;
    EXPECT_EQ(compute_visual_hull(views_, {}, scratch_).status, HullStatus::kEmptyIntersection);
}

TEST_F(FaultyViews, NeedsTwoViews) {
    EXPECT_EQ(compute_visual_hull(std::span(views_).first(1), {}, scratch_).status,
              HullStatus::kTooFewViews);
    EXPECT_EQ(compute_visual_hull({}, {}, scratch_).status, HullStatus::kTooFewViews);
    const std::vector<SilhouetteView> same{views_[0], views_[0]};
    EXPECT_EQ(compute_visual_hull(same, {}, scratch_).status, HullStatus::kTooFewViews);
}

TEST_F(FaultyViews, IsUnboundedWhereAllCamerasLookTheSameWay) {
    SilhouetteView beside = views_[0];
    beside.camera_from_site.translation.x() += 0.3;
    const std::vector<SilhouetteView> pair{views_[0], beside};
    EXPECT_EQ(compute_visual_hull(pair, {}, scratch_).status, HullStatus::kUnbounded);
}

TEST_F(FaultyViews, RefusesNumbersThatAreNone) {
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

TEST_F(FaultyViews, RefusesMoreViewsThanItCanName) {
    const std::vector<SilhouetteView> views(kMaxViews + 1, views_[0]);
    EXPECT_EQ(compute_visual_hull(views, {}, scratch_).status, HullStatus::kInvalidInput);
}

TEST_F(FaultyViews, RefusesMoreWorkThanAllowed) {
    HullOptions options;
    options.max_segments = 100;
    EXPECT_EQ(compute_visual_hull(views_, options, scratch_).status, HullStatus::kTooComplex);
}

TEST(HullOfCombs, StopsAfterTheAllowedSteps) {
    // twelve combs across each other: many crossings on every strip
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

TEST_F(FaultyViews, LeavesOutContoursWithoutArea) {
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
