#include "site_node/hull_stage.hpp"

#include "tests/support/allocation_counter.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/unit/refine/dish_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string_view>

namespace atrium::site_node {
namespace {

using testing::HasSubstr;

constexpr double kTolerance_px = 0.75;
const geometry::Aabb kRoom{{-1, -1, 0}, {1, 1, 2}};

std::string error_of(const std::vector<geometry::CalibratedCamera>& cameras,
                     const HullStageOptions& options) {
    const auto stage = HullStage::create(cameras, options, kTolerance_px);
    if (stage) return "no error";
    EXPECT_EQ(stage.error().kind, ErrorKind::kConfiguration);
    return stage.error().message;
}

TEST(HullStage, NamesTheKeyThatDoesNotFitTheRig) {
    auto cameras = atrium::test::make_ring_rig({.num_cameras = 4});
    HullStageOptions options;
    options.min_views = 5;
    EXPECT_THAT(error_of(cameras, options),
                testing::AllOf(HasSubstr("hull.min_views"), HasSubstr("4"), HasSubstr("5")));
    options = {};
    options.regions = {{"stage", kRoom, {"cam0", "cam7"}}};
    EXPECT_THAT(error_of(cameras, options),
                testing::AllOf(HasSubstr("hull.region[0].cameras"),
                               HasSubstr("no camera is named 'cam7'"),
                               HasSubstr("cam0, cam1, cam2, cam3")));
    options.regions[0].cameras = {"cam0", "cam0"};
    EXPECT_THAT(error_of(cameras, options), HasSubstr("'cam0' is named twice"));
    options.regions[0].cameras = {"cam0"};
    EXPECT_THAT(error_of(cameras, options), HasSubstr("at least 2"));
    options.regions[0].cameras = {"cam0", "cam1"};
    options.min_views = 3;
    EXPECT_THAT(error_of(cameras, options), HasSubstr("at least 3"));
    options = {};
    options.partial_views = true;
    EXPECT_THAT(error_of(cameras, options), HasSubstr("hull.partial_views: needs hull.bounds"));
    options.bounds = kRoom;
    options.whole_cameras = {"top"};
    EXPECT_THAT(error_of(cameras, options), HasSubstr("hull.whole_cameras: no camera is named"));
    options.whole_cameras = {"cam0", "cam0"};
    EXPECT_THAT(error_of(cameras, options), HasSubstr("hull.whole_cameras: 'cam0' is named twice"));
    options.whole_cameras.clear();
    cameras[2].intrinsics.distortion[0] = -30.0;
    EXPECT_THAT(error_of(cameras, options),
                testing::AllOf(HasSubstr("distortion"), HasSubstr("'cam2'")));
    options.whole_cameras = {"cam2"};
    EXPECT_EQ(error_of(cameras, options), "no error");
}

TEST(HullStage, AllowsBoundsBesideTheMaximumOfCameras) {
    HullStageOptions options;
    EXPECT_EQ(error_of(atrium::test::make_ring_rig({.num_cameras = 64}), options), "no error");
    options.bounds = kRoom;
    EXPECT_EQ(error_of(atrium::test::make_ring_rig({.num_cameras = 62}), options), "no error");
    EXPECT_THAT(error_of(atrium::test::make_ring_rig({.num_cameras = 63}), options),
                testing::AllOf(HasSubstr("hull.bounds"), HasSubstr("62"), HasSubstr("63")));
}

// Bounds cost nothing where they cut nothing, and cut from the first metaframe on in which they
// must.
// A hull has at most 64 views, bounds included; a room of 64 cameras has several hulls.
TEST(HullStage, AllowsRegionsInARoomOfTheMaximumOfCameras) {
    const auto cameras = atrium::test::make_ring_rig({.num_cameras = 64});
    HullStageOptions options;
    options.regions = {{"stage", kRoom, {"cam0", "cam21", "cam42", "cam63"}}};
    auto stage = HullStage::create(cameras, options, kTolerance_px);
    ASSERT_TRUE(stage) << stage.error().message;
    SerialExecutor executor;
    hull::VisualHull hull;
    stage->compute(std::vector<std::uint8_t>(64, 1), {}, executor, hull);
    EXPECT_EQ(hull.status, hull::HullStatus::kEmptyIntersection);
    options.regions[0].cameras.clear();
    EXPECT_THAT(
        error_of(cameras, options),
        testing::AllOf(HasSubstr("hull.region[0].cameras"), HasSubstr("62"), HasSubstr("64")));
}

TEST(HullStage, CutsAtTheBoundsExactlyWhileTheHullReachesOut) {
    const auto rig = atrium::test::make_ring_rig({.num_cameras = 6});
    HullStageOptions with;
    with.bounds = kRoom;
    auto bounded = HullStage::create(rig, with, kTolerance_px);
    auto unbounded = HullStage::create(rig, {}, kTolerance_px);
    ASSERT_TRUE(bounded && unbounded);
    const std::vector<std::uint8_t> all(rig.size(), 1);
    SerialExecutor executor;
    hull::VisualHull cut;
    hull::VisualHull whole;
    int num_cut = 0;
    for (int i = 0; i < 120; ++i) {
        // walks across the border of the room, stays outside for a while, and comes back
        const double x = i < 20 ? 0.0 : i < 30 ? 0.1 * (i - 20) : i < 60 ? 0.9 : 0.2;
        for (std::size_t v = 0; v < rig.size(); ++v) {
            const auto outline =
                atrium::test::outline_of(atrium::test::Sphere{{x, 0.0, 0.9}, 0.3}, rig[v], 30);
            bounded->contours(v) = {outline};
            unbounded->contours(v) = {outline};
        }
        bounded->compute(all, {}, executor, cut);
        unbounded->compute(all, {}, executor, whole);
        ASSERT_EQ(cut.status, hull::HullStatus::kOk);
        ASSERT_EQ(whole.status, hull::HullStatus::kOk);
        const geometry::Aabb box = geometry::bounds(whole.mesh);
        const bool reaches_out = box.max.x() > kRoom.max.x();
        num_cut += reaches_out;
        EXPECT_LE(geometry::bounds(cut.mesh).max.x(), kRoom.max.x() + 1e-6) << i;
        if (reaches_out) {
            EXPECT_LT(geometry::volume_m3(cut.mesh), geometry::volume_m3(whole.mesh)) << i;
        } else {
            EXPECT_NEAR(geometry::volume_m3(cut.mesh), geometry::volume_m3(whole.mesh), 1e-9) << i;
        }
        if (i < 20 || i >= 100) {  // no trace of the bounds
            EXPECT_EQ(cut.mesh.vertices, whole.mesh.vertices) << i;
            EXPECT_EQ(cut.mesh.triangles, whole.mesh.triangles) << i;
        }
    }
    EXPECT_GT(num_cut, 30);
    EXPECT_LT(num_cut, 50);
}

class TwoBodies : public testing::Test {
protected:
    TwoBodies() {
        options_.min_component_l = 30.0;  // nobody is where cones past both bodies meet
        options_.regions = {{"left", {{-2, -0.6, 0.2}, {-1, 0.6, 1.6}}, {"cam0", "cam2", "cam4"}},
                            {"right", {{1, -0.6, 0.2}, {2, 0.6, 1.6}}, {}}};
    }
    HullStage make_stage() {
        auto stage = HullStage::create(rig_, options_, kTolerance_px);
        EXPECT_TRUE(stage) << stage.error().message;
        for (std::size_t v = 0; v < rig_.size(); ++v) {
            for (const double x : {-1.5, 1.5}) {
                stage->contours(v).push_back(atrium::test::outline_of(
                    atrium::test::Sphere{{x, 0.0, 0.9}, 0.3}, rig_[v], 30));
            }
        }
        return std::move(*stage);
    }
    std::vector<geometry::CalibratedCamera> rig_ =
        atrium::test::make_ring_rig({.num_cameras = 8, .first_angle_rad = 0.4});
    HullStageOptions options_;
    SerialExecutor executor_;
    hull::VisualHull hull_;
};

TEST_F(TwoBodies, AreComputedInTheirRegions) {
    HullStage stage = make_stage();
    stage.compute(std::vector<std::uint8_t>(8, 1), {}, executor_, hull_);
    ASSERT_EQ(hull_.status, hull::HullStatus::kOk) << to_string(hull_.status);
    EXPECT_EQ(hull_.num_components, 2u);
    EXPECT_EQ(hull_.num_regions_failed, 0u);
    double left_l = 0.0;
    // the hull of a ball from three cameras is larger than that from eight
    for (const bool with_left : {true, false}) {
        options_.regions[0].cameras.clear();
        if (with_left) options_.regions[0].cameras = {"cam0", "cam2", "cam4"};
        HullStage other = make_stage();
        other.compute(std::vector<std::uint8_t>(8, 1), {}, executor_, hull_);
        const double volume = geometry::volume_m3(hull_.mesh);
        if (with_left) {
            left_l = volume;
        } else {
            EXPECT_LT(volume, left_l);
        }
    }
}

TEST_F(TwoBodies, AreRoundedOnRequestInEachRegionAsAlone) {
    const std::vector<std::uint8_t> all(8, 1);
    HullStage exact = make_stage();
    exact.compute(all, {}, executor_, hull_);
    const double exact_m3 = geometry::volume_m3(hull_.mesh);
    options_.refine = "round";
    HullStage rounded = make_stage();
    rounded.compute(all, {}, executor_, hull_);
    ASSERT_EQ(hull_.status, hull::HullStatus::kOk);
    const geometry::MeshReport report = geometry::inspect(hull_.mesh);
    EXPECT_TRUE(report.manifold);
    EXPECT_EQ(report.num_components, 2U);
    EXPECT_LT(report.volume_m3, 0.98 * exact_m3);
    double parts_m3 = 0.0;
    for (const hull::VisualHull& part : rounded.region_hulls())
        parts_m3 += geometry::volume_m3(part.mesh);
    EXPECT_NEAR(parts_m3, report.volume_m3, 1e-9);

    const double left_m3 = geometry::volume_m3(rounded.region_hulls()[0].mesh);
    options_.regions.pop_back();
    HullStage alone = make_stage();
    alone.compute(all, {}, executor_, hull_);
    EXPECT_NEAR(geometry::volume_m3(hull_.mesh), left_m3, 1e-9);
}

TEST_F(TwoBodies, AreRoundedWithoutRegions) {
    options_.regions.clear();
    HullStage exact = make_stage();
    const std::vector<std::uint8_t> all(8, 1);
    exact.compute(all, {}, executor_, hull_);
    const double exact_m3 = geometry::volume_m3(hull_.mesh);
    options_.refine = "round";
    HullStage rounded = make_stage();
    rounded.compute(all, {}, executor_, hull_);
    EXPECT_TRUE(geometry::inspect(hull_.mesh).manifold);
    EXPECT_LT(geometry::volume_m3(hull_.mesh), 0.99 * exact_m3);
}

TEST_F(TwoBodies, HaveAnotherFingerprintRefined) {
    std::set<std::uint64_t> fingerprints;
    for (const char* refine : {"off", "round", "photo", "round_photo"}) {
        options_.refine = refine;
        EXPECT_TRUE(fingerprints.insert(fingerprint(options_)).second) << refine;
        EXPECT_EQ(needs_pictures(options_), std::string_view(refine).ends_with("photo"));
    }
}

TEST(HullStage, MovesTheSurfaceToWhereThePicturesAgree) {
    const refine::DishScene scene = refine::film_dish({}, 21);
    const std::vector<refine::PictureView> pictures = scene.views();
    const auto hull_of = [&](const HullStageOptions& options,
                             std::span<const refine::PictureView> seen,
                             std::size_t num_delivered) {
        auto stage = HullStage::create(scene.cameras, options, kTolerance_px);
        EXPECT_TRUE(stage) << stage.error().message;
        EXPECT_EQ(stage->uses_pictures(), needs_pictures(options));
        std::vector<std::uint8_t> delivered(scene.cameras.size(), 0);
        for (std::size_t i = 0; i < num_delivered; ++i) {
            stage->contours(i) = scene.contours[i];
            delivered[i] = 1;
        }
        SerialExecutor executor;
        hull::VisualHull hull;
        stage->compute(delivered, seen, executor, hull);
        EXPECT_EQ(hull.status, hull::HullStatus::kOk);
        EXPECT_TRUE(geometry::inspect(hull.mesh).manifold);
        return hull.mesh;
    };
    HullStageOptions options;
    const std::size_t all = scene.cameras.size();
    const double exact_m3 = geometry::volume_m3(hull_of(options, pictures, all));
    const double exact_of_8_m3 = geometry::volume_m3(hull_of(options, pictures, 8));
    options.refine = "photo";
    const double refined_m3 = geometry::volume_m3(hull_of(options, pictures, all));
    EXPECT_LT(refined_m3, 0.98 * exact_m3);
    // a lost camera, no pictures at all
    EXPECT_LT(geometry::volume_m3(hull_of(options, pictures, 8)), 0.98 * exact_of_8_m3);
    EXPECT_EQ(geometry::volume_m3(hull_of(options, {}, all)), exact_m3);
    // corners first
    options.refine = "round";
    const double rounded_m3 = geometry::volume_m3(hull_of(options, pictures, all));
    options.refine = "round_photo";
    EXPECT_EQ(geometry::volume_m3(hull_of(options, {}, all)), rounded_m3);
    EXPECT_LT(geometry::volume_m3(hull_of(options, pictures, all)), 0.98 * rounded_m3);
    options.refine = "photo";
    // each region with its own cameras
    options.regions = {{"here", {{-0.5, -0.5, -0.1}, {0.5, 0.5, 0.5}}, {}},
                       {"beside", {{1.0, 1.0, -0.1}, {2.0, 2.0, 0.5}}, {"cam0", "cam1", "cam2"}}};
    EXPECT_NEAR(geometry::volume_m3(hull_of(options, pictures, all)), refined_m3, 2e-3 * exact_m3);
}

// Refined by pictures, the metaframe before counts, also beside a region without anybody.
TEST(HullStage, RemembersTheMetaframeBeforeUnlessItHadNoHullOrPaused) {
    const refine::DishScene before = refine::film_dish({}, 22);
    const refine::DishScene scene = refine::film_dish({}, 23);
    HullStageOptions options;
    options.refine = "photo";
    for (const bool with_regions : {false, true}) {
        SCOPED_TRACE(with_regions);
        if (with_regions) {
            options.regions = {{"here", {{-0.5, -0.5, -0.1}, {0.5, 0.5, 0.5}}, {}},
                               {"beside", {{1.0, 1.0, -0.1}, {2.0, 2.0, 0.5}}, {}}};
        }
        SerialExecutor executor;
        const auto make = [&] {
            auto stage = HullStage::create(scene.cameras, options, kTolerance_px);
            EXPECT_TRUE(stage) << stage.error().message;
            for (std::size_t i = 0; i < scene.cameras.size(); ++i)
                stage->contours(i) = scene.contours[i];
            return std::move(*stage);
        };
        const std::vector<std::uint8_t> all(scene.cameras.size(), 1);
        const std::vector<std::uint8_t> none(scene.cameras.size(), 0);
        hull::VisualHull alone;
        make().compute(all, scene.views(), executor, alone);
        ASSERT_EQ(alone.status, hull::HullStatus::kOk);
        enum class Between : std::uint8_t { kNothing, kNoHull, kPause };
        for (const Between between : {Between::kNothing, Between::kNoHull, Between::kPause}) {
            HullStage stage = make();
            hull::VisualHull hull;
            stage.compute(all, before.views(), executor, hull);
            if (between == Between::kNoHull) stage.compute(none, before.views(), executor, hull);
            if (between == Between::kPause) {
                stage.pause_pictures(true);
                stage.compute(all, before.views(), executor, hull);
                EXPECT_GT(geometry::volume_m3(hull.mesh), geometry::volume_m3(alone.mesh) / 0.98);
                stage.pause_pictures(false);
            }
            stage.compute(all, scene.views(), executor, hull);
            EXPECT_EQ(hull.mesh.vertices == alone.mesh.vertices, between != Between::kNothing);
        }
    }
}

TEST_F(TwoBodies, LoseARegionWithTooFewCamerasUntilTheyReturn) {
    HullStage stage = make_stage();
    std::vector<std::uint8_t> delivered(8, 1);
    stage.compute(delivered, {}, executor_, hull_);
    const geometry::TriangleMesh all = hull_.mesh;
    delivered[0] = delivered[4] = 0;  // one of three is left to the first region
    stage.compute(delivered, {}, executor_, hull_);
    ASSERT_EQ(hull_.status, hull::HullStatus::kOk);
    EXPECT_EQ(hull_.num_components, 1u);
    EXPECT_EQ(hull_.num_regions_failed, 1u);
    EXPECT_GT(geometry::bounds(hull_.mesh).min.x(), 1.0 - 1e-5);
    delivered.assign(8, 1);
    stage.compute(delivered, {}, executor_, hull_);
    EXPECT_EQ(hull_.num_regions_failed, 0u);
    EXPECT_EQ(hull_.mesh.vertices, all.vertices);
}

TEST_F(TwoBodies, AllocateNothingOnceWarmEvenIfCamerasComeAndGo) {
    for (const bool with_regions : {true, false}) {
        if (!with_regions) options_.regions.clear();
        HullStage stage = make_stage();
        std::uint64_t warm = 0;
        for (int round = 0; round < 4; ++round) {
            if (round == 2) warm = atrium::test::num_allocations();
            for (int lost = 0; lost < 8; ++lost) {
                std::array<std::uint8_t, 8> delivered;
                delivered.fill(1);
                delivered[static_cast<std::size_t>(lost)] = 0;
                delivered[4] = lost == 0 ? 0 : 1;
                stage.compute(delivered, {}, executor_, hull_);
            }
        }
        EXPECT_EQ(atrium::test::num_allocations() - warm, 0u) << "regions " << with_regions;
    }
}

TEST_F(TwoBodies, NeedTheMinimumNumberOfCameras) {
    options_ = {};
    options_.bounds = geometry::Aabb{{-2, -1, 0}, {2, 1, 2}};
    HullStage two = make_stage();
    std::vector<std::uint8_t> delivered{0, 0, 0, 1, 0, 0, 0, 0};
    two.compute(delivered, {}, executor_, hull_);
    // bounds do not count as a second camera
    EXPECT_EQ(hull_.status, hull::HullStatus::kTooFewViews);
    EXPECT_TRUE(hull_.mesh.empty());
    delivered[5] = 1;
    two.compute(delivered, {}, executor_, hull_);
    EXPECT_EQ(hull_.status, hull::HullStatus::kOk);
    options_.min_views = 3;
    HullStage three = make_stage();
    three.compute(delivered, {}, executor_, hull_);
    EXPECT_EQ(hull_.status, hull::HullStatus::kTooFewViews);
}

}  // namespace
}  // namespace atrium::site_node
