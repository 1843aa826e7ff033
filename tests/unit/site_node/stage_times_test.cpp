#include "site_node/stage_times.hpp"

#include "site_node/overload_advice.hpp"

#include <gtest/gtest.h>

namespace atrium::site_node {
namespace {

using namespace std::chrono_literals;

TEST(StageTimes, AreMediansAndBytesPerSecondOfEachTopic) {
    StageTimes times;
    bus::SiteStatus status;
    times.put_into(status);
    EXPECT_EQ(status.stages, bus::StageTimes{}) << "all times must be zero before a measurement";
    const std::chrono::steady_clock::time_point begin{100s};
    times.update_rates(begin);
    for (const double ms : {1.0, 2.0, 30.0}) {
        SiteFrame frame;
        frame.milliseconds = {
            .silhouettes = ms, .hull = 10 * ms, .encode = 100 * ms, .total = 111 * ms};
        frame.work_milliseconds.segmentation = 30 * ms;
        times.computed(frame);
        times.published(500, 7000, 3ms, 40ms);
    }
    times.update_rates(begin + 2s);
    times.put_into(status);
    EXPECT_EQ(status.stages, (bus::StageTimes{2.0, 20.0, 200.0, 3.0}));
    EXPECT_EQ(status.capture_to_publish.median_ms, 40.0);
    EXPECT_DOUBLE_EQ(status.mesh_bytes_per_s, 750.0);
    EXPECT_DOUBLE_EQ(status.texture_bytes_per_s, 10'500.0);
    times.update_rates(begin + 3s);
    times.put_into(status);
    EXPECT_EQ(status.mesh_bytes_per_s, 0.0) << "the rate must be zero if nothing was sent since";
    times.update_rates(begin + 4s);
    times.put_into(status);
    EXPECT_EQ(status.stages.hull_ms, 20.0) << "a slow site";
    times.update_rates(begin + 5s);
    times.put_into(status);
    EXPECT_EQ(status.stages, bus::StageTimes{}) << "old times would show a site that works";
    EXPECT_EQ(status.capture_to_publish.num_samples, 0u);
}

TEST(StageTimes, NameTheStageWithMostWork) {
    StageTimes times;
    EXPECT_FALSE(times.largest_work());
    SiteFrame frame;
    frame.work_milliseconds = {
        .segmentation = 30.0, .polygons = 2.0, .hull = 10.0, .mesh = 5.0, .textures = 3.0};
    times.computed(frame);
    const auto work = times.largest_work();
    ASSERT_TRUE(work);
    EXPECT_EQ(work->name, "segmentation");
    EXPECT_DOUBLE_EQ(work->share, 0.6);
    EXPECT_FALSE(work->is_wait);
    EXPECT_EQ(work->remedy, "");
    frame.work_milliseconds.refinement = 40.0;
    times.computed(frame);
    const auto refined = times.largest_work();
    EXPECT_EQ(refined->name, "the refinement of the hull");
    EXPECT_EQ(refined->remedy, "set hull.refine = \"off\"");
    EXPECT_FALSE(refined->is_wait);
    frame.work_milliseconds.waiting = 50.0;
    times.computed(frame);
    EXPECT_TRUE(times.largest_work()->is_wait);
    EXPECT_FALSE(times.largest_work()) << "of the time since the last call only";
}

TEST(OverloadAdvice, NamesStageThreadsAndRate) {
    using atrium::status::Cause;
    Overload overload{60.0, 11.4, 1.02, 1, 8, StageTimes::Work{"segmentation", 0.7}};
    EXPECT_EQ(overload_advice(overload, Cause::kWork),
              "60/s asked, 11.4 done: segmentation takes 70 % of the work; raise site.threads to 7 "
              "(1.0 of 8 cores are used), or set capture.rate_hz = 10");
    EXPECT_EQ(overload_advice(overload, Cause::kMachine),
              "60/s asked, 11.4 done: segmentation takes 70 % of the work; run fewer programs on "
              "this host, or set capture.rate_hz = 10");
    overload.threads = 8;
    overload.done_hz = 0.9;
    EXPECT_EQ(overload_advice(overload, Cause::kWork),
              "60/s asked, 0.9 done: segmentation takes 70 % of the work; use fewer or smaller "
              "pictures, or set capture.rate_hz = 0.8");
    Overload refining = overload;
    refining.largest_work = {"the refinement of the hull", 0.6, false, "set hull.refine = \"off\""};
    EXPECT_EQ(overload_advice(refining, Cause::kWork),
              "60/s asked, 0.9 done: the refinement of the hull takes 60 % of the work; set "
              "hull.refine = \"off\", use fewer or smaller pictures, or set capture.rate_hz = 0.8");
    Overload waiting = overload;
    waiting.largest_work = {"waiting for hosts of regions", 0.9, true};
    EXPECT_NE(
        overload_advice(waiting, Cause::kMachine)
            .find("waiting for hosts of regions takes 90 % of the work; give them fewer regions"),
        std::string::npos);
    EXPECT_EQ(overload_advice(overload, Cause::kStoodStill), "");
}

}  // namespace
}  // namespace atrium::site_node
