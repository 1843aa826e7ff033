#include "site_node/hull/regions.hpp"

#include "tests/support/allocation_counter.hpp"
#include "tests/support/shapes/hull_checks.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

namespace atrium::hull {
namespace {

using test::expect_closed;
using test::expect_sound;

constexpr double kRadius_m = 0.4;
const Eigen::Vector3d kMiddle(0.0, 0.0, 0.9);

geometry::Aabb box(const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
    geometry::Aabb result;
    result.add(min);
    result.add(max);
    return result;
}

class Bounds : public testing::Test {
protected:
    Bounds()
        : rig_(test::make_ring_rig({.num_cameras = 8})),
          views_(test::views_of(test::Sphere{kMiddle, kRadius_m}, rig_, 40)) {}
    std::vector<const SilhouetteView*> pointers() const {
        std::vector<const SilhouetteView*> result;
        for (const SilhouetteView& view : views_) result.push_back(&view);
        return result;
    }
    std::vector<geometry::CalibratedCamera> rig_;
    std::vector<SilhouetteView> views_;
    HullScratch scratch_;
};

TEST_F(Bounds, ChangeNothingIfFarAway) {
    const VisualHull free = compute_visual_hull(views_, {}, scratch_);
    HullOptions options;
    options.bounds = box({-1.0, -1.0, 0.0}, {1.0, 1.0, 2.0});
    const VisualHull bounded = compute_visual_hull(views_, options, scratch_);
    expect_sound(bounded);
    EXPECT_EQ(bounded.mesh.vertices.size(), free.mesh.vertices.size());
    EXPECT_NEAR(geometry::volume_m3(bounded.mesh), geometry::volume_m3(free.mesh), 1e-8);
}

TEST_F(Bounds, CutTheHullWithPlanes) {
    const VisualHull whole = compute_visual_hull(views_, {}, scratch_);
    double sum = 0.0;
    for (const bool upper : {false, true}) {
        HullOptions options;
        options.bounds = upper ? box({-1.0, -1.0, 0.93}, {1.0, 1.0, 2.0})
                               : box({-1.0, -1.0, 0.0}, {1.0, 1.0, 0.93});
        const VisualHull half = compute_visual_hull(views_, options, scratch_);
        expect_sound(half);
        const geometry::Aabb extent = geometry::bounds(half.mesh);
        EXPECT_NEAR(upper ? extent.min.z() : extent.max.z(), 0.93, 1e-6);
        sum += geometry::volume_m3(half.mesh);
    }
    EXPECT_NEAR(sum, geometry::volume_m3(whole.mesh), 1e-7);
}

TEST_F(Bounds, CloseTheConeOfOneCamera) {
    HullOptions options;
    options.bounds = box({-0.5, -0.5, 0.5}, {0.5, 0.5, 1.5});
    // a square pyramid from a camera in front of a cube, cut at both ends
    geometry::CalibratedCamera camera;
    camera.intrinsics = {1000, 1000, 1000.0, 1000.0, 499.5, 499.5};
    camera.camera_from_site = test::look_at({3.0, 0.0, 1.0}, {0.0, 0.0, 1.0});
    const SilhouetteView view =
        test::make_view(camera, {{{449.5, 449.5}, {549.5, 449.5}, {549.5, 549.5}, {449.5, 549.5}}});
    const VisualHull hull = compute_visual_hull(std::vector{view}, options, scratch_);
    expect_sound(hull);
    // widths grow by 0.1 m per metre of distance: 2.5 m to 3.5 m
    EXPECT_NEAR(
        geometry::volume_m3(hull.mesh), 0.01 * (3.5 * 3.5 * 3.5 - 2.5 * 2.5 * 2.5) / 3.0, 1e-8);
    EXPECT_EQ(hull.mesh.vertices.size(), 8u);
}

TEST_F(Bounds, AreTheHullWhereNoCameraCutsIt) {
    HullOptions options;
    options.bounds = box({-0.05, -0.1, 0.8}, {0.05, 0.1, 1.0});  // inside the sphere
    const VisualHull hull = compute_visual_hull(views_, options, scratch_);
    // no viewing edge reaches it, but it is no phantom: the bounds have cut the edges off
    expect_sound(hull);
    EXPECT_EQ(hull.mesh.vertices.size(), 8u);
    EXPECT_NEAR(geometry::volume_m3(hull.mesh), 0.1 * 0.2 * 0.2, 1e-8);
    EXPECT_EQ(hull.num_phantoms_dropped, 0u);
}

TEST_F(Bounds, WithoutExtentAreRefused) {
    HullOptions options;
    options.bounds = box({-1.0, -1.0, 0.5}, {1.0, 1.0, 0.5});
    EXPECT_EQ(compute_visual_hull(views_, options, scratch_).status, HullStatus::kInvalidInput);
    options.bounds = geometry::Aabb{};
    EXPECT_EQ(compute_visual_hull(views_, options, scratch_).status, HullStatus::kInvalidInput);
}

class Regions : public Bounds {
protected:
    // two bodies, 3 m apart, seen side by side by all cameras
    Regions() {
        rig_ = test::make_ring_rig({.num_cameras = 8, .first_angle_rad = std::numbers::pi / 8.0});
        for (const double x : {-1.5, 1.5}) {
            for (std::size_t v = 0; v < rig_.size(); ++v) {
                const test::Sphere body{{x, 0.0, 0.9}, 0.3};
                if (x < 0.0) two_.push_back(test::make_view(rig_[v], {}));
                two_[v].contours.push_back(test::outline_of(body, rig_[v], 30));
            }
        }
        for (const SilhouetteView& view : two_) pointers_.push_back(&view);
        options_.min_component_volume_m3 = 0.03;  // nobody is where cones past both bodies meet
        regions_ = {{"left", box({-2.0, -0.6, 0.2}, {-1.0, 0.6, 1.6}), {}, 1},
                    {"right", box({1.0, -0.6, 0.2}, {2.0, 0.6, 1.6}), {}, 1}};
    }
    VisualHull compute(const std::vector<Region>& regions) {
        VisualHull hull;
        SerialExecutor executor;
        compute_region_hulls(pointers_, regions, options_, region_scratch_, executor, hull);
        return hull;
    }
    std::vector<SilhouetteView> two_;
    std::vector<const SilhouetteView*> pointers_;
    std::vector<Region> regions_;
    HullOptions options_;
    RegionScratch region_scratch_;
};

TEST_F(Regions, MakeOneMeshOfAllBodies) {
    const VisualHull hull = compute(regions_);
    expect_sound(hull);
    EXPECT_EQ(hull.num_components, 2u);
    const VisualHull whole = compute_visual_hull(two_, options_, scratch_);
    EXPECT_NEAR(geometry::volume_m3(hull.mesh), geometry::volume_m3(whole.mesh), 1e-7);
}

TEST_F(Regions, ContinueWithoutALostCamera) {
    const VisualHull all = compute(regions_);
    pointers_[2] = nullptr;
    const VisualHull hull = compute(regions_);
    expect_sound(hull);
    EXPECT_EQ(hull.num_components, 2u);
    EXPECT_GT(geometry::volume_m3(hull.mesh), geometry::volume_m3(all.mesh));
}

TEST_F(Regions, AllocateNothingOnceWarm) {
    for (SilhouetteView& view : two_)
        view.field = {{300.0, 2.0}, {997.0, 2.0}, {997.0, 997.0}, {300.0, 997.0}};
    options_.min_views = 3;
    VisualHull hull;
    SerialExecutor executor;
    const auto compute = [&] {
        compute_region_hulls(pointers_, regions_, options_, region_scratch_, executor, hull);
    };
    for (int i = 0; i < 2; ++i) compute();
    const std::uint64_t before = test::num_allocations();
    compute();
    EXPECT_EQ(test::num_allocations() - before, 0u);
    expect_closed(hull);
}

TEST_F(Regions, UseOnlyTheirOwnCameras) {
    regions_[0].views = {0, 2, 4, 6};
    const VisualHull four = compute({regions_[0]});
    regions_[0].views.clear();
    const VisualHull eight = compute({regions_[0]});
    expect_sound(four);
    EXPECT_GT(geometry::volume_m3(four.mesh), geometry::volume_m3(eight.mesh));
}

TEST_F(Regions, WithoutCamerasAreSkippedAndCounted) {
    regions_[0].views = {3};
    pointers_[3] = nullptr;
    const VisualHull hull = compute(regions_);
    expect_sound(hull);
    EXPECT_EQ(hull.num_components, 1u);
    EXPECT_EQ(hull.num_regions_failed, 1u);
    EXPECT_EQ(compute({regions_[0]}).status, HullStatus::kTooFewViews);
}

TEST_F(Regions, WithTooFewCamerasAreSkippedAndCounted) {
    regions_[0].views = {1, 3, 5};
    pointers_[3] = nullptr;
    for (const std::uint32_t num_missing : {0u, 1u}) {
        regions_[0].min_delivered = 2 + num_missing;
        const VisualHull hull = compute(regions_);
        ASSERT_EQ(hull.status, HullStatus::kOk);
        EXPECT_EQ(hull.num_regions_failed, num_missing);
        const bool has_left = geometry::bounds(hull.mesh).min.x() < 0.0;
        EXPECT_EQ(has_left, num_missing == 0);
        EXPECT_LT(0.0, geometry::bounds(hull.mesh).max.x());
        // nothing of the previous region's hull appears again
        EXPECT_EQ(compute({regions_[1], regions_[0]}).num_components, hull.num_components);
    }
    EXPECT_EQ(compute({regions_[0]}).status, HullStatus::kTooFewViews);
    EXPECT_TRUE(compute({regions_[0]}).mesh.empty());
    regions_[1].min_delivered = 8;  // all eight cameras, one of which is missing
    EXPECT_EQ(compute({regions_[1]}).status, HullStatus::kTooFewViews);
    regions_[1].min_delivered = 7;
    EXPECT_EQ(compute({regions_[1]}).status, HullStatus::kOk);
}

TEST_F(Regions, RefuseUnknownCameras) {
    regions_[1].views = {0, 8};
    const VisualHull hull = compute(regions_);
    EXPECT_EQ(hull.status, HullStatus::kInvalidInput);
    EXPECT_TRUE(hull.mesh.empty());
}

TEST_F(Regions, AreEmptyWithoutABody) {
    EXPECT_EQ(compute({{"empty", box({-0.5, -0.5, 0.0}, {0.5, 0.5, 2.0}), {}, 1}}).status,
              HullStatus::kEmptyIntersection);
    EXPECT_EQ(compute({}).status, HullStatus::kEmptyIntersection);
}

}  // namespace
}  // namespace atrium::hull
