#include "site_node/pipeline.hpp"

#include "core/base/thread_pool.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/winding_number.hpp"
#include "tests/unit/site_node/capsule_room.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <thread>

namespace atrium::site_node {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const geometry::Aabb kSpace{{-0.7, -0.8, 0.0}, {0.7, 0.8, 1.9}};
const std::vector<test::Capsule> kBody = test::make_body({0, 0, 0});
// A pixel of these cameras is about 7 mm wide at the body. Outlines are accurate to about a pixel.
constexpr double kMargin_m = 0.02;

config::Rig make_rig(double focal_px) {
    config::Rig rig;
    rig.cameras = atrium::test::make_ring_rig({.num_cameras = 8,
                                               .radius_m = 3.0,
                                               .heights_m = {1.0, 2.2},
                                               .size_px = 240,
                                               .focal_px = focal_px});
    rig.bounds_site = kSpace;
    return rig;
}

// Four cameras look at the upper half of the body and four at the lower half. None sees the whole
// body.
config::Rig make_close_rig() {
    config::Rig rig = make_rig(500.0);
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        geometry::CalibratedCamera& camera = rig.cameras[i];
        camera.camera_from_site =
            atrium::test::look_at(camera.centre_site(), {0.0, 0.0, (i / 2) % 2 == 0 ? 1.25 : 0.45});
        if (i % 3 == 0) camera.intrinsics.distortion = {-0.3, 0.1, 0.001, -0.002, 0.0};
    }
    return rig;
}

class SitePipeline : public testing::Test {
protected:
    Pipeline make(const config::Rig& rig, const PipelineOptions& options = {}) {
        test::StillSource source(rig);
        auto pipeline = Pipeline::create(source, options, {});
        EXPECT_TRUE(pipeline) << pipeline.error().message;
        return std::move(*pipeline);
    }
    void process(Pipeline& pipeline, const capture::Metaframe& metaframe) {
        const auto done = pipeline.process(metaframe, executor_, frame_);
        ASSERT_TRUE(done) << done.error().message;
    }
    std::size_t num_outside(const std::vector<Eigen::Vector3d>& points) const {
        return static_cast<std::size_t>(
            std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
                return std::lround(atrium::test::winding_number(frame_.hull.mesh, p)) != 1;
            }));
    }
    std::vector<std::uint32_t> textured() const {
        std::vector<std::uint32_t> cameras;
        for (const CodedCamera& camera : frame_.cameras) cameras.push_back(camera.camera);
        std::sort(cameras.begin(), cameras.end());
        return cameras;
    }

    SerialExecutor executor_;
    SiteFrame frame_;
    const std::vector<Eigen::Vector3d> points_ = test::points_inside(kBody, kMargin_m, 300);
};

TEST_F(SitePipeline, HullContainsACompletelySeenPerson) {
    const config::Rig rig = make_rig(250.0);
    Pipeline pipeline = make(rig);
    process(pipeline, test::take_pictures(kBody, rig));
    EXPECT_EQ(frame_.hull.status, hull::HullStatus::kOk);
    EXPECT_EQ(num_outside(points_), 0u);
    EXPECT_FALSE(frame_.draco.empty());
    EXPECT_THAT(textured(), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST_F(SitePipeline, ClosedBordersCutAPersonWhoLeavesThePictures) {
    const config::Rig rig = make_close_rig();
    Pipeline pipeline = make(rig);
    process(pipeline, test::take_pictures(kBody, rig));
    EXPECT_GT(num_outside(points_), points_.size() / 4);
}

TEST_F(SitePipeline, PartialViewsContainAPersonWhoLeavesThePictures) {
    const config::Rig rig = make_close_rig();
    const capture::Metaframe metaframe = test::take_pictures(kBody, rig);
    PipelineOptions options;
    options.hull.partial_views = true;
    options.hull.bounds = kSpace;
    for (const std::uint32_t min_views : {0u, 3u}) {
        options.hull.min_views = min_views;
        Pipeline pipeline = make(rig, options);
        process(pipeline, metaframe);
        EXPECT_EQ(frame_.hull.status, hull::HullStatus::kOk);
        EXPECT_EQ(num_outside(points_), 0u) << "min_views " << min_views;
        const geometry::MeshReport report = geometry::inspect(frame_.hull.mesh);
        EXPECT_TRUE(report.closed && report.manifold);
        const geometry::Aabb extent = geometry::bounds(frame_.hull.mesh);
        EXPECT_TRUE((extent.min.array() > kSpace.min.array() - 1e-5).all());
        EXPECT_TRUE((extent.max.array() < kSpace.max.array() + 1e-5).all());
    }
    // the body has 0.09 m3; parts that fewer than three cameras see are missing
    EXPECT_LT(geometry::volume_m3(frame_.hull.mesh), 0.2);
}

TEST_F(SitePipeline, WholeCamerasCutEvenAmongPartialOnes) {
    const config::Rig rig = make_close_rig();
    PipelineOptions options;
    options.hull.partial_views = true;
    options.hull.bounds = kSpace;
    options.hull.whole_cameras = {"cam0"};  // this camera does not really see the whole body
    Pipeline pipeline = make(rig, options);
    process(pipeline, test::take_pictures(kBody, rig));
    EXPECT_GT(num_outside(points_), 0u);
}

TEST_F(SitePipeline, ContinuesWithoutALostCameraAndTakesItBack) {
    const config::Rig rig = make_rig(250.0);
    const capture::Metaframe all = test::take_pictures(kBody, rig);
    capture::Metaframe seven = all;
    seven.frames[2].image = {};
    seven.frames[2].silhouette = nullptr;
    Pipeline pipeline = make(rig);
    process(pipeline, all);
    const std::vector<std::uint8_t> draco = frame_.draco;
    const double volume = geometry::volume_m3(frame_.hull.mesh);

    process(pipeline, seven);
    EXPECT_EQ(num_outside(points_), 0u);
    EXPECT_GT(geometry::volume_m3(frame_.hull.mesh), volume);
    EXPECT_THAT(textured(), ElementsAre(0, 1, 3, 4, 5, 6, 7));

    // the same result as if the camera had never existed
    config::Rig smaller = rig;
    smaller.cameras.erase(smaller.cameras.begin() + 2);
    Pipeline other = make(smaller);
    SiteFrame expected;
    capture::Metaframe without = all;
    without.frames.erase(without.frames.begin() + 2);
    for (std::size_t i = 0; i < without.frames.size(); ++i) without.frames[i].camera = i;
    ASSERT_TRUE(other.process(without, executor_, expected));
    EXPECT_EQ(frame_.draco, expected.draco);

    process(pipeline, all);
    EXPECT_EQ(frame_.draco, draco);
    EXPECT_THAT(textured(), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

// A source whose camera 3 cannot show the empty room now.
class DarkSource final : public capture::FrameSource {
public:
    explicit DarkSource(config::Rig rig) : rig_(std::move(rig)) {}
    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return false; }
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override {
        const auto show = [&](std::size_t camera) -> Expected<void> {
            if (camera == 3) return make_error(ErrorKind::kUnavailable, "no pictures came");
            const int size = rig_.cameras[camera].intrinsics.width;
            const image::YuvImage grey{image::Plane(size, size, 90),
                                       image::Plane(size / 2, size / 2, 128),
                                       image::Plane(size / 2, size / 2, 128)};
            for (int i = 0; i < 5; ++i) sink(camera, grey);
            return {};
        };
        return capture::one_after_another(cameras, show, stop);
    }
    Expected<void> run(std::stop_token, const Sink&) override { return {}; }

private:
    config::Rig rig_;
};

TEST_F(SitePipeline, SkipsACameraThatCannotShowTheEmptyRoom) {
    const config::Rig rig = make_rig(250.0);
    DarkSource source(rig);
    auto pipeline = Pipeline::create(source, {}, {});
    ASSERT_TRUE(pipeline) << pipeline.error().message;
    EXPECT_THAT(pipeline->cameras_without_background(), ElementsAre("cam3"));
    process(*pipeline, test::take_pictures(kBody, rig));
    EXPECT_EQ(frame_.hull.status, hull::HullStatus::kOk);
    EXPECT_EQ(num_outside(points_), 0u);
    EXPECT_THAT(textured(), ElementsAre(0, 1, 2, 4, 5, 6, 7));
}

TEST_F(SitePipeline, RefusesOneCameraAlone) {
    const config::Rig rig = make_rig(250.0);
    const capture::Metaframe all = test::take_pictures(kBody, rig);
    capture::Metaframe one = all;
    for (std::size_t i = 1; i < one.frames.size(); ++i) one.frames[i].image = {};
    for (const bool bounded : {false, true}) {
        PipelineOptions options;
        if (bounded) options.hull.bounds = kSpace;
        Pipeline pipeline = make(rig, options);
        const auto done = pipeline.process(one, executor_, frame_);
        ASSERT_FALSE(done);
        EXPECT_THAT(done.error().message, HasSubstr("too few views"));
        process(pipeline, all);
    }
}

TEST_F(SitePipeline, CountsOmittedParts) {
    const config::Rig rig = make_rig(250.0);
    capture::Metaframe metaframe = test::take_pictures(kBody, rig);
    PipelineOptions options;
    options.hull.min_component_l = 1000.0;
    Pipeline pipeline = make(rig, options);
    process(pipeline, metaframe);
    EXPECT_EQ(frame_.losses.fragments, 1u);
    EXPECT_GT(frame_.losses.dropped_l, 10.0);
    EXPECT_LT(frame_.losses.dropped_l, 1000.0);
    EXPECT_TRUE(frame_.draco.empty());  // no person

    options = {};
    options.hull.regions = {{"here", kSpace, {}},
                            {"elsewhere", {{5, 5, 0}, {6, 6, 2}}, {"cam0", "cam1"}}};
    Pipeline with_regions = make(rig, options);
    process(with_regions, metaframe);
    EXPECT_EQ(frame_.losses.cameras, 0u);
    EXPECT_EQ(frame_.losses.fragments, 0u);
    EXPECT_LT(frame_.losses.dropped_l, 10.0);
    EXPECT_EQ(frame_.losses.regions_failed, 0u);
    EXPECT_EQ(num_outside(points_), 0u);
    metaframe.frames[1].image = {};
    process(with_regions, metaframe);
    EXPECT_EQ(frame_.losses.cameras, 1u);
    EXPECT_EQ(frame_.losses.regions_failed, 1u);
    EXPECT_EQ(num_outside(points_), 0u);
}

// A host of region 1 that answers as told.
struct RemoteRegion final : hosts::RemoteRegions {
    void order(const bus::FrameKey& frame,
               std::span<const hull::SilhouetteView> /*views*/,
               std::span<const std::uint8_t> /*delivered*/) override {
        ordered = frame;
    }
    std::vector<bus::RegionMeshes> collect() override {
        bus::RegionMeshes answer;
        answer.host = "helper";
        answer.regions = {{1, outcome, 0}};
        const bool has_failed = outcome != bus::RegionOutcome::kNobody;
        answer.reason = has_failed ? "nothing comes from it" : "";
        answer.left_out.num_regions_failed = has_failed ? 1 : 0;
        return {answer};
    }
    bus::RegionOutcome outcome = bus::RegionOutcome::kFailed;
    bus::FrameKey ordered;
};

TEST_F(SitePipeline, GoesOnWithoutTheRegionsOfALostHost) {
    const config::Rig rig = make_rig(250.0);
    PipelineOptions options;
    options.hull.regions = {{"here", kSpace, {}}, {"there", {{5, 5, 0}, {6, 6, 2}}, {}}};
    options.hull.regions[1].is_elsewhere = true;
    RemoteRegion remote;
    Pipeline pipeline = make(rig, options);
    pipeline.set_remote_regions(&remote);
    const capture::Metaframe somebody = test::take_pictures(kBody, rig);
    process(pipeline, somebody);
    EXPECT_EQ(remote.ordered, (bus::FrameKey{somebody.frame_id, somebody.capture_time}));
    EXPECT_FALSE(frame_.draco.empty());
    // who has left the region of this host must not stay in it
    process(pipeline, test::take_pictures({}, rig));
    EXPECT_TRUE(frame_.draco.empty());
    EXPECT_EQ(frame_.losses.regions_failed, 1u);

    options.hull.regions[0].is_elsewhere = true;
    Pipeline without_own = make(rig, options);
    without_own.set_remote_regions(&remote);
    const auto failed = without_own.process(somebody, executor_, frame_);
    ASSERT_FALSE(failed);
    EXPECT_THAT(failed.error().message, HasSubstr("no hull: host helper: nothing comes from it"));
    remote.outcome = bus::RegionOutcome::kNobody;
    process(without_own, somebody);
    EXPECT_TRUE(frame_.draco.empty());
}

// Two threads that share a pool run the first stage of each metaframe beside the second stage of
// the previous one. They give the same bytes as one metaframe after another.
TEST_F(SitePipeline, OverlappingMetaframesEqualSequentialOnes) {
    const config::Rig rig = make_rig(250.0);
    std::vector<capture::Metaframe> metaframes;
    for (int i = 0; i < 6; ++i) {
        metaframes.push_back(test::take_pictures(test::make_body({0.02 * i, 0.0, 0.0}), rig));
        metaframes.back().frame_id = static_cast<std::uint64_t>(i) + 1;
    }
    metaframes[2].frames[3].image = {};  // a camera fails
    metaframes[4] = test::take_pictures({}, rig);
    metaframes[4].frame_id = 5;
    std::vector<SiteFrame> expected(metaframes.size());
    Pipeline serial = make(rig);
    for (std::size_t i = 0; i < metaframes.size(); ++i)
        ASSERT_TRUE(serial.process(metaframes[i], executor_, expected[i]));

    Pipeline pipeline = make(rig);
    ThreadPool pool(3);
    std::array<Pipeline::Silhouettes, 2> silhouettes;
    ASSERT_TRUE(pipeline.find_silhouettes(metaframes[0], executor_, silhouettes[0]));
    for (std::size_t i = 0; i < metaframes.size(); ++i) {
        std::optional<ThreadPool::Priority> priority(pool);
        std::jthread next([&] {
            if (i + 1 == metaframes.size()) return;
            EXPECT_TRUE(pipeline.find_silhouettes(
                metaframes[i + 1], pool.background(), silhouettes[(i + 1) % 2]));
        });
        const ColourCoding coding{PipelineOptions{}.jpeg_quality, 1};
        ASSERT_TRUE(pipeline.compute(silhouettes[i % 2], coding, pool, frame_));
        priority.reset();
        next.join();
        EXPECT_EQ(frame_.frame_id, expected[i].frame_id);
        EXPECT_EQ(frame_.draco, expected[i].draco) << i;
        EXPECT_EQ(frame_.losses.cameras, expected[i].losses.cameras) << i;
        ASSERT_EQ(frame_.cameras.size(), expected[i].cameras.size()) << i;
        for (std::size_t c = 0; c < frame_.cameras.size(); ++c) {
            EXPECT_EQ(frame_.cameras[c].camera, expected[i].cameras[c].camera);
            EXPECT_EQ(frame_.cameras[c].texture.colour, expected[i].cameras[c].texture.colour);
            EXPECT_EQ(frame_.cameras[c].texture.mask, expected[i].cameras[c].texture.mask);
        }
        const std::size_t num_outlines = silhouettes[i % 2].delivered_outlines(0).size();
        EXPECT_EQ(num_outlines, i == 4 ? 0u : 1u) << i;
        EXPECT_EQ(silhouettes[i % 2].metaframe().frame_id, i + 1);
    }
}

}  // namespace
}  // namespace atrium::site_node
