#include "tools/simulated_cameras/shown_pictures.hpp"

#include <gtest/gtest.h>

namespace atrium::simulated_cameras {
namespace {

using std::chrono::microseconds;

constexpr std::int64_t kStart_us = 1'795'288'687'250'000;

TEST(TriggerNumbers, AreEqualForOneInstantDespiteDelays) {
    for (const std::int64_t period_us : {50'000, 33'333, 16'667}) {
        const std::int64_t tick_us = kStart_us / period_us * period_us;
        const auto first = TriggerNumbers::free_running(tick_us, period_us);
        for (const std::int64_t late_us : {std::int64_t{1}, period_us / 2, period_us - 1}) {
            const auto other = TriggerNumbers::free_running(tick_us + late_us, period_us);
            EXPECT_EQ(other.number, first.number);
            EXPECT_EQ(other.time_us, tick_us);
        }
        EXPECT_EQ(TriggerNumbers::free_running(tick_us + period_us, period_us).number,
                  first.number + 1);
    }
}

TEST(TriggerNumbers, AreEqualForSoftwareTriggersOfDifferentCameras) {
    TriggerNumbers numbers(3);
    constexpr std::int64_t kPeriod_us = 50'000;
    for (int round = 0; round < 5; ++round) {
        const std::int64_t now_us = kStart_us + round * 41'000;
        const auto first = numbers.software(0, now_us, kPeriod_us);
        EXPECT_EQ(first.time_us, now_us);
        for (const std::size_t camera : {2u, 1u}) {
            const auto other = numbers.software(camera, now_us + 3'000, kPeriod_us);
            EXPECT_EQ(other.number, first.number + 3);  // each reports its trigger time
            EXPECT_EQ(other.time_us, now_us);
        }
    }
    // the same camera again means the next trigger, however soon
    const std::int64_t last_us = kStart_us + 4 * 41'000;
    EXPECT_EQ(numbers.software(1, last_us + 4'000, kPeriod_us).time_us, last_us + 4'000);
    // a camera that is late by more than half a period gets its own number
    EXPECT_EQ(numbers.software(0, last_us + 40'000, kPeriod_us).time_us, last_us + 40'000);
}

TEST(ShowSchedule, EmptiesTheRoomFirstThenRepeatsTheMotion) {
    ShowSchedule schedule(4, 10, 20.0, microseconds(1'000'000));
    for (int i = 0; i < 20; ++i) {
        const auto choice = schedule.at(kStart_us + i * 50'000);
        EXPECT_TRUE(choice.is_empty_room) << i;
        EXPECT_EQ(choice.index, static_cast<std::size_t>(i % 4));
    }
    for (int i = 0; i < 25; ++i) {
        const auto choice = schedule.at(kStart_us + 1'000'000 + i * 50'000);
        EXPECT_FALSE(choice.is_empty_room) << i;
        EXPECT_EQ(choice.index, static_cast<std::size_t>(i % 10));
    }
}

TEST(ShowSchedule, EmptiesTheRoomOnRequest) {
    ShowSchedule schedule(4, 10, 20.0, microseconds(1'000'000));
    EXPECT_FALSE((schedule.at(kStart_us), schedule.at(kStart_us + 1'500'000)).is_empty_room);
    schedule.empty_room(kStart_us + 1'500'000);
    EXPECT_TRUE(schedule.at(kStart_us + 1'500'000).is_empty_room);
    EXPECT_TRUE(schedule.at(kStart_us + 2'450'000).is_empty_room);
    EXPECT_FALSE(schedule.at(kStart_us + 2'500'000).is_empty_room);
}

TEST(ShowSchedule, StartsTheMotionAtOnceWithoutEmptyRoomPictures) {
    ShowSchedule schedule(0, 10, 20.0, microseconds(1'000'000));
    EXPECT_FALSE(schedule.at(kStart_us).is_empty_room);
    EXPECT_EQ(schedule.at(kStart_us).index, 0u);
}

TEST(ShowSchedule, RoundedPeriodsMissNoInstant) {
    // the period of 30 Hz is no whole number of microseconds
    ShowSchedule schedule(1, 1000, 30.0, microseconds(0));
    for (int i = 0; i < 900; ++i) {
        EXPECT_EQ(schedule.at(kStart_us + i * 33'333).index, static_cast<std::size_t>(i));
    }
}

}  // namespace
}  // namespace atrium::simulated_cameras
