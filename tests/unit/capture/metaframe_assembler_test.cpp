#include "site_node/capture/metaframe_assembler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace atrium::capture {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::int64_t kPeriodNs = 33'000'000;
const AssemblerOptions kOptions{milliseconds(10), milliseconds(100)};

CameraFrame frame(std::size_t camera, std::int64_t time_ns) {
    CameraFrame f;
    f.camera = camera;
    f.capture_time = {time_ns};
    f.image = std::make_shared<const image::YuvImage>();
    return f;
}

Clock::time_point at(int ms) { return Clock::time_point{} + milliseconds(ms); }

TEST(MetaframeAssembler, CompletesWhenTheLastCameraArrives) {
    MetaframeAssembler assembler(3, kOptions);
    EXPECT_FALSE(assembler.add(frame(2, 1000), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, 3000), at(1)));
    const auto metaframe = assembler.add(frame(1, 2000), at(2));
    ASSERT_TRUE(metaframe);
    ASSERT_EQ(metaframe->frames.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(metaframe->frames[i].camera, i);
    EXPECT_EQ(metaframe->capture_time.ns, 1000);
}

TEST(MetaframeAssembler, MatchesByTimeAndNotByArrival) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(1, 2 * kPeriodNs),
                               at(1)));  // of the next trigger, though it came second
    const auto first = assembler.add(frame(1, kPeriodNs + 5), at(2));
    ASSERT_TRUE(first);
    EXPECT_EQ(first->frames[1].capture_time.ns, kPeriodNs + 5);
    const auto second = assembler.add(frame(0, 2 * kPeriodNs - 3), at(3));
    ASSERT_TRUE(second);
    EXPECT_GT(second->frame_id, first->frame_id);
    EXPECT_EQ(assembler.counters().num_incomplete, 0u);
}

TEST(MetaframeAssembler, DropsWhatIsIncompleteAtItsDeadlineAndCountsIt) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    assembler.expire(at(99));
    EXPECT_EQ(assembler.counters().num_incomplete, 0u);
    assembler.expire(at(101));
    EXPECT_EQ(assembler.counters().num_incomplete, 1u);
    EXPECT_FALSE(assembler.add(frame(1, kPeriodNs),
                               at(102)));  // too late: opens one that will miss the other camera
}

TEST(MetaframeAssembler, NewerCompleteOneDropsOlderIncompleteOnes) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, 2 * kPeriodNs), at(1)));
    EXPECT_TRUE(assembler.add(frame(1, 2 * kPeriodNs), at(2)));
    EXPECT_EQ(assembler.counters().num_incomplete, 1u);
    EXPECT_FALSE(assembler.add(frame(1, kPeriodNs), at(3)));
    EXPECT_EQ(assembler.counters().num_stray, 1u);
}

TEST(MetaframeAssembler, CountsStraysAndKeepsTheFirstOfTwoPicturesOfOneCamera) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(frame(5, kPeriodNs), at(0)));
    CameraFrame empty = frame(0, kPeriodNs);
    empty.image = nullptr;
    EXPECT_FALSE(assembler.add(empty, at(0)));
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs + 1), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs + 2), at(0)));
    const auto metaframe = assembler.add(frame(1, kPeriodNs), at(0));
    ASSERT_TRUE(metaframe);
    EXPECT_EQ(metaframe->frames[0].capture_time.ns, kPeriodNs + 1);
    EXPECT_EQ(assembler.counters().num_stray, 3u);
}

TEST(MetaframeAssembler, ACameraWithAWildClockDoesNotFillTheMemory) {
    MetaframeAssembler assembler(2, kOptions);
    for (int i = 1; i <= 1000; ++i) EXPECT_FALSE(assembler.add(frame(0, i * kPeriodNs), at(0)));
    EXPECT_GE(assembler.counters().num_incomplete, 990u);
}

// any order of arrival within the deadline, some pictures lost
TEST(MetaframeAssembler, NeverMixesTriggersAndNeverGoesBack) {
    std::mt19937 random(11);
    for (int round = 0; round < 50; ++round) {
        constexpr std::size_t kNumCameras = 5;
        struct Arrival {
            CameraFrame frame;
            int ms;
        };
        std::vector<Arrival> arrivals;
        for (int trigger = 1; trigger <= 30; ++trigger) {
            for (std::size_t camera = 0; camera < kNumCameras; ++camera) {
                if (random() % 40 == 0) continue;
                const auto jitter = static_cast<std::int64_t>(random() % 4'000'000);
                arrivals.push_back({frame(camera, trigger * kPeriodNs + jitter),
                                    trigger * 33 + static_cast<int>(random() % 60)});
            }
        }
        std::stable_sort(arrivals.begin(), arrivals.end(), [](const auto& a, const auto& b) {
            return a.ms < b.ms;
        });
        MetaframeAssembler assembler(kNumCameras, kOptions);
        std::int64_t last_trigger = 0;
        std::uint64_t num_metaframes = 0;
        for (Arrival& arrival : arrivals) {
            const auto metaframe = assembler.add(std::move(arrival.frame), at(arrival.ms));
            if (!metaframe) continue;
            ++num_metaframes;
            const std::int64_t trigger = metaframe->capture_time.ns / kPeriodNs;
            EXPECT_GT(trigger, last_trigger);
            last_trigger = trigger;
            for (const CameraFrame& f : metaframe->frames)
                EXPECT_EQ(f.capture_time.ns / kPeriodNs, trigger);
        }
        EXPECT_GT(num_metaframes, 5u);
        EXPECT_EQ(num_metaframes, assembler.counters().num_complete);
    }
}

}  // namespace
}  // namespace atrium::capture
