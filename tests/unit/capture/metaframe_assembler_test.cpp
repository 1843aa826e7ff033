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
    static const auto picture = std::make_shared<const image::YuvImage>(
        image::YuvImage{image::Plane(2, 2), image::Plane(1, 1), image::Plane(1, 1)});
    f.image = picture;
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

TEST(MetaframeAssembler, MatchesByTimeNotByArrival) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(1, 2 * kPeriodNs),
                               at(1)));  // belongs to the next trigger, although it came second
    const auto first = assembler.add(frame(1, kPeriodNs + 5), at(2));
    ASSERT_TRUE(first);
    EXPECT_EQ(first->frames[1].capture_time.ns, kPeriodNs + 5);
    const auto second = assembler.add(frame(0, 2 * kPeriodNs - 3), at(3));
    ASSERT_TRUE(second);
    EXPECT_GT(second->frame_id, first->frame_id);
    EXPECT_EQ(assembler.counters().num_incomplete, 0u);
}

TEST(MetaframeAssembler, DropsAndCountsIncompleteMetaframesAtTheirDeadline) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    assembler.expire(at(99));
    EXPECT_EQ(assembler.counters().num_incomplete, 0u);
    assembler.expire(at(101));
    EXPECT_EQ(assembler.counters().num_incomplete, 1u);
    EXPECT_FALSE(assembler.add(frame(1, kPeriodNs),
                               // too late: it opens a metaframe that will lack the other camera
                               at(102)));
}

TEST(MetaframeAssembler, NewerCompleteMetaframeDropsOlderIncompleteOnes) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, 2 * kPeriodNs), at(1)));
    EXPECT_TRUE(assembler.add(frame(1, 2 * kPeriodNs), at(2)));
    EXPECT_EQ(assembler.counters().num_incomplete, 1u);
    EXPECT_FALSE(assembler.add(frame(1, kPeriodNs), at(3)));
    EXPECT_EQ(assembler.counters().num_stray, 1u);
}

TEST(MetaframeAssembler, CountsStraysAndKeepsTheFirstOfTwoPictures) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(frame(5, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs + 1), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs + 2), at(0)));
    const auto metaframe = assembler.add(frame(1, kPeriodNs), at(0));
    ASSERT_TRUE(metaframe);
    EXPECT_EQ(metaframe->frames[0].capture_time.ns, kPeriodNs + 1);
    EXPECT_EQ(assembler.counters().num_stray, 2u);
}

TEST(MetaframeAssembler, StaysBoundedWithARandomCameraClock) {
    MetaframeAssembler assembler(2, kOptions);
    for (int i = 1; i <= 1000; ++i) EXPECT_FALSE(assembler.add(frame(0, i * kPeriodNs), at(0)));
    EXPECT_GE(assembler.counters().num_incomplete, 990u);
}

const AssemblerOptions kTwoAreEnough{milliseconds(10), milliseconds(100), 2};

TEST(MetaframeAssembler, ReturnsMetaframesWithEnoughCamerasAtTheirDeadline) {
    MetaframeAssembler assembler(3, kTwoAreEnough);
    EXPECT_FALSE(assembler.add(frame(2, kPeriodNs + 7), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs + 5), at(1)));
    EXPECT_FALSE(assembler.expire(at(100)));
    const auto metaframe = assembler.expire(at(101));
    ASSERT_TRUE(metaframe);
    ASSERT_EQ(metaframe->frames.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(metaframe->frames[i].camera, i);
    EXPECT_FALSE(metaframe->frames[0].image.empty());
    EXPECT_TRUE(metaframe->frames[1].image.empty());
    EXPECT_EQ(metaframe->capture_time.ns, kPeriodNs + 5);
    EXPECT_EQ(assembler.counters().num_incomplete_used, 1u);
    EXPECT_EQ(assembler.counters().num_incomplete, 0u);
    EXPECT_EQ(assembler.counters().num_complete, 0u);
    EXPECT_FALSE(assembler.add(frame(1, kPeriodNs), at(102)));  // too late
    EXPECT_EQ(assembler.counters().num_stray, 1u);
}

TEST(MetaframeAssembler, DropsMetaframesWithTooFewCamerasAtTheirDeadline) {
    MetaframeAssembler assembler(3, kTwoAreEnough);
    EXPECT_FALSE(assembler.add(frame(1, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.expire(at(101)));
    EXPECT_EQ(assembler.counters().num_incomplete, 1u);
    EXPECT_EQ(assembler.counters().num_incomplete_used, 0u);
}

TEST(MetaframeAssembler, ContinuesWithoutALostCameraAndTakesItBack) {
    MetaframeAssembler assembler(3, kTwoAreEnough);
    std::vector<std::uint64_t> ids;
    std::vector<bool> has_camera1;
    for (int trigger = 1; trigger <= 30; ++trigger) {
        for (std::size_t camera : {0u, 2u, 1u}) {
            if (camera == 1 && trigger > 5 && trigger <= 20) continue;
            const auto metaframe =
                assembler.add(frame(camera, trigger * kPeriodNs), at(33 * trigger));
            if (!metaframe) continue;
            ids.push_back(metaframe->frame_id);
            has_camera1.push_back(!metaframe->frames[1].image.empty());
        }
    }
    EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
    // of the 15 triggers without it, the last three were within their deadline when it returned
    EXPECT_EQ(assembler.counters().num_incomplete_used, 12u);
    EXPECT_EQ(assembler.counters().num_incomplete, 3u);
    EXPECT_EQ(assembler.counters().num_complete, 15u);
    EXPECT_EQ(std::count(has_camera1.begin(), has_camera1.end(), true), 15);
    EXPECT_EQ(ids.size(), 27u);
}

TEST(MetaframeAssembler, TellsWhenTheNextMetaframeExpires) {
    MetaframeAssembler assembler(3, kTwoAreEnough);
    EXPECT_FALSE(assembler.next_expiry());
    EXPECT_FALSE(assembler.add(frame(0, 2 * kPeriodNs), at(10)));
    EXPECT_FALSE(assembler.add(frame(2, 2 * kPeriodNs), at(12)));
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(20)));  // older, but came later
    const auto expiry = assembler.next_expiry();
    ASSERT_TRUE(expiry);
    EXPECT_FALSE(assembler.expire(*expiry - std::chrono::nanoseconds(1)));
    EXPECT_EQ(assembler.counters().num_incomplete, 0u);
    EXPECT_EQ(*expiry, at(110) + std::chrono::nanoseconds(1));
    EXPECT_TRUE(assembler.expire(*expiry));
    EXPECT_FALSE(assembler.next_expiry());
}

TEST(MetaframeAssembler, ReturnsOnlyTheNewestOfSeveralPastDeadline) {
    MetaframeAssembler assembler(3, kTwoAreEnough);
    for (int trigger = 1; trigger <= 3; ++trigger) {
        for (const std::size_t camera : {0u, 2u})
            EXPECT_FALSE(assembler.add(frame(camera, trigger * kPeriodNs), at(trigger)));
    }
    const auto metaframe = assembler.add(frame(0, 9 * kPeriodNs), at(300));
    ASSERT_TRUE(metaframe);
    EXPECT_EQ(metaframe->capture_time.ns, 3 * kPeriodNs);
    EXPECT_EQ(assembler.counters().num_incomplete, 2u);
    EXPECT_EQ(assembler.counters().num_incomplete_used, 1u);
}

TEST(MetaframeAssembler, PrefersACompleteMetaframeToAnOlderDueOne) {
    MetaframeAssembler assembler(2, {milliseconds(10), milliseconds(100), 1});
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, 2 * kPeriodNs), at(33)));
    const auto metaframe = assembler.add(frame(1, 2 * kPeriodNs), at(101));
    ASSERT_TRUE(metaframe);
    EXPECT_EQ(metaframe->capture_time.ns, 2 * kPeriodNs);
    EXPECT_EQ(assembler.counters().num_complete, 1u);
    EXPECT_EQ(assembler.counters().num_incomplete, 1u);
    EXPECT_EQ(assembler.counters().num_incomplete_used, 0u);
}

TEST(MetaframeAssembler, ReturnsTheLastMetaframeWhenTheSourceEnds) {
    MetaframeAssembler assembler(3, kTwoAreEnough);
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(1, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(1, 2 * kPeriodNs), at(33)));
    const auto metaframe = assembler.finish();
    ASSERT_TRUE(metaframe);
    EXPECT_EQ(metaframe->capture_time.ns, kPeriodNs);
    EXPECT_EQ(assembler.counters().num_incomplete, 1u);
    EXPECT_FALSE(assembler.finish());
}

TEST(MetaframeAssembler, KeepsFastTriggersWhileACameraIsLost) {
    // more triggers within one deadline than the assembler keeps waiting
    MetaframeAssembler assembler(3, kTwoAreEnough);
    std::int64_t last_ns = 0;
    std::uint64_t num_metaframes = 0;
    for (int trigger = 1; trigger <= 100; ++trigger) {
        for (const std::size_t camera : {0u, 2u}) {
            const auto metaframe = assembler.add(frame(camera, trigger * kPeriodNs), at(trigger));
            if (!metaframe) continue;
            EXPECT_GT(metaframe->capture_time.ns, last_ns);
            last_ns = metaframe->capture_time.ns;
            ++num_metaframes;
        }
    }
    EXPECT_EQ(num_metaframes, 92u);
    EXPECT_EQ(assembler.counters().num_incomplete, 0u);
}

CameraFrame lost(std::size_t camera, std::int64_t time_ns) {
    CameraFrame f = frame(camera, time_ns);
    f.image = {};
    return f;
}

TEST(MetaframeAssembler, DoesNotWaitForALostPicture) {
    for (const bool comes_first : {true, false}) {
        MetaframeAssembler assembler(3, kTwoAreEnough);
        std::optional<Metaframe> metaframe;
        if (comes_first) {
            EXPECT_FALSE(assembler.add(lost(1, kPeriodNs + 3), at(0)));
        }
        EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(1)));
        metaframe = assembler.add(frame(2, kPeriodNs + 1), at(2));
        EXPECT_EQ(metaframe.has_value(), comes_first);
        if (!comes_first) metaframe = assembler.add(lost(1, kPeriodNs + 3), at(3));
        ASSERT_TRUE(metaframe);
        EXPECT_TRUE(metaframe->frames[1].image.empty());
        EXPECT_EQ(metaframe->capture_time.ns, kPeriodNs);
        EXPECT_EQ(assembler.counters().num_incomplete_used, 1u);
        EXPECT_FALSE(assembler.add(lost(1, kPeriodNs), at(4)));  // reported twice, too late
        EXPECT_EQ(assembler.counters().num_stray, 0u);
    }
}

TEST(MetaframeAssembler, DropsHopelessMetaframesAtOnce) {
    MetaframeAssembler assembler(3, kTwoAreEnough);
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(lost(1, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(lost(1, kPeriodNs), at(0)));
    EXPECT_EQ(assembler.counters().num_incomplete, 0u);
    EXPECT_FALSE(assembler.add(lost(2, kPeriodNs), at(0)));
    EXPECT_EQ(assembler.counters().num_incomplete, 1u);
}

TEST(MetaframeAssembler, AcceptsAPictureReportedAsLost) {
    MetaframeAssembler assembler(2, kOptions);
    EXPECT_FALSE(assembler.add(lost(0, kPeriodNs), at(0)));
    EXPECT_FALSE(assembler.add(frame(0, kPeriodNs), at(0)));
    EXPECT_TRUE(assembler.add(frame(1, kPeriodNs), at(0)));
    EXPECT_EQ(assembler.counters().num_complete, 1u);
}

// any order of arrival within the deadline, with some pictures lost
// The clock of all pictures was set back by an hour: not an hour of silence.
TEST(MetaframeAssembler, BeginsAnewWhenTheClockOfAllPicturesWasSetBack) {
    MetaframeAssembler assembler(2, kOptions);
    constexpr std::int64_t kHour_ns = 3'600'000'000'000;
    int ms = 0;
    const auto num_of = [&](std::int64_t start_ns, int num_instants) {
        std::size_t num = 0;
        for (int i = 0; i < num_instants; ++i) {
            for (std::size_t camera = 0; camera < 2; ++camera)
                num += assembler.add(frame(camera, start_ns + i * kPeriodNs), at(++ms)) ? 1 : 0;
        }
        return num;
    };
    EXPECT_EQ(num_of(2 * kHour_ns, 10), 10u);
    EXPECT_GE(num_of(kHour_ns, 10), 6u);
    // one camera alone cannot do that
    for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(assembler.add(frame(1, i * kPeriodNs), at(++ms)));
        EXPECT_EQ(num_of(kHour_ns + (20 + i) * kPeriodNs, 1), 1u) << i;
    }
}

TEST(MetaframeAssembler, NeverMixesTriggersOrGoesBack) {
    std::mt19937 random(11);
    for (int round = 0; round < 100; ++round) {
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
        const std::size_t min_cameras = round % 2 == 0 ? 0 : 3;
        MetaframeAssembler assembler(kNumCameras,
                                     {milliseconds(10), milliseconds(50), min_cameras});
        std::int64_t last_trigger = 0;
        std::uint64_t num_metaframes = 0;
        for (Arrival& arrival : arrivals) {
            const auto metaframe = assembler.add(std::move(arrival.frame), at(arrival.ms));
            if (!metaframe) continue;
            ++num_metaframes;
            const std::int64_t trigger = metaframe->capture_time.ns / kPeriodNs;
            EXPECT_GT(trigger, last_trigger);
            last_trigger = trigger;
            std::size_t num_present = 0;
            for (const CameraFrame& f : metaframe->frames) {
                if (f.image.empty()) continue;
                ++num_present;
                EXPECT_EQ(f.capture_time.ns / kPeriodNs, trigger);
            }
            EXPECT_GE(num_present, min_cameras == 0 ? kNumCameras : min_cameras);
        }
        EXPECT_GT(num_metaframes, 5u);
        const AssemblerCounters& counters = assembler.counters();
        EXPECT_EQ(num_metaframes, counters.num_complete + counters.num_incomplete_used);
        EXPECT_TRUE(min_cameras > 0 || counters.num_incomplete_used == 0);
    }
}

}  // namespace
}  // namespace atrium::capture
