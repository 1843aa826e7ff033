#include "site_node/record/instant_numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::record {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

constexpr auto kPeriod = 40ms;

// Cameras at 25 Hz. Pictures arrive 10 ms after they were taken.
class Instants : public testing::Test {
protected:
    InstantNumbers numbers_{3, kPeriod};

    std::uint64_t number(std::size_t camera,
                         std::chrono::milliseconds taken,
                         std::chrono::milliseconds clock_error = 0ms) {
        const auto arrival = InstantNumbers::Clock::time_point(taken + 10ms);
        return numbers_.number(camera, Timestamp{} + taken + clock_error, arrival);
    }
    std::vector<std::uint64_t> numbers(std::chrono::milliseconds taken,
                                       std::chrono::milliseconds clock_error = 0ms) {
        return {number(0, taken, clock_error),
                number(1, taken + 3ms, clock_error),
                number(2, taken - 4ms, clock_error)};
    }
};

TEST_F(Instants, GiveOneNumberToPicturesOfOneInstant) {
    EXPECT_THAT(numbers(1000ms), ElementsAre(0, 0, 0));
    EXPECT_THAT(numbers(1040ms), ElementsAre(1, 1, 1));
    EXPECT_THAT(numbers(1080ms), ElementsAre(2, 2, 2));
    EXPECT_EQ(numbers_.next(), 3u);
}

TEST_F(Instants, LeaveOutThePictureThatACameraLost) {
    numbers(1000ms);
    EXPECT_EQ(number(0, 1040ms), 1u);
    EXPECT_EQ(number(0, 1080ms), 2u);
    EXPECT_EQ(number(1, 1080ms), 2u);
    EXPECT_EQ(number(2, 1042ms), 1u);  // late
    EXPECT_EQ(number(2, 1079ms), 2u);
}

TEST_F(Instants, CountAnInstantThatAllCamerasLost) {
    numbers(1000ms);
    for (int i = 0; i < 3; ++i)
        numbers_.note_lost(Timestamp{} + 1040ms, InstantNumbers::Clock::time_point(1050ms));
    EXPECT_THAT(numbers(1080ms), ElementsAre(2, 2, 2));
    numbers_.note_lost(Timestamp{} + 1081ms, InstantNumbers::Clock::time_point(1095ms));
    EXPECT_EQ(numbers_.next(), 3u);
}

TEST_F(Instants, GoOnWithoutAGapAfterAPause) {
    numbers(1000ms);
    EXPECT_THAT(numbers(61'000ms), ElementsAre(1, 1, 1));
}

TEST_F(Instants, GrowWhenTheClockIsSetBack) {
    numbers(10'000ms);
    EXPECT_FALSE(numbers_.take_step_back());
    EXPECT_THAT(numbers(10'040ms, -5000ms), ElementsAre(1, 1, 1));
    const auto step = numbers_.take_step_back();
    ASSERT_TRUE(step);
    EXPECT_EQ(*step, 4960ms);
    EXPECT_FALSE(numbers_.take_step_back());
    EXPECT_THAT(numbers(10'080ms, -5000ms), ElementsAre(2, 2, 2));
}

TEST_F(Instants, GrowWhenTheClockIsSetBackByLessThanASecond) {
    for (int i = 0; i < 20; ++i) numbers(10'000ms + i * kPeriod);
    EXPECT_THAT(numbers(10'800ms, -300ms), ElementsAre(20, 20, 20));
    EXPECT_THAT(numbers(10'840ms, -300ms), ElementsAre(21, 21, 21));
}

TEST_F(Instants, GrowWhenTheClockIsSetForward) {
    numbers(10'000ms);
    EXPECT_THAT(numbers(10'040ms, 3'600'000ms), ElementsAre(1, 1, 1));
}

TEST_F(Instants, FollowTheArrivalOfACameraWithAWildClock) {
    for (int i = 0; i < 20; ++i) {
        const auto taken = 10'000ms + i * kPeriod;
        const auto expected = static_cast<std::uint64_t>(i);
        EXPECT_EQ(number(0, taken), expected);
        EXPECT_EQ(number(1, taken, -7'777'000ms), expected);
        EXPECT_EQ(number(2, taken), expected);
    }
}

TEST_F(Instants, FollowTheArrivalOfACameraWithAWildClockThatComesFirst) {
    for (int i = 0; i < 20; ++i) {
        const auto taken = 10'000ms + i * kPeriod;
        const auto expected = static_cast<std::uint64_t>(i);
        EXPECT_EQ(number(1, taken, 7'777'000ms), expected);
        EXPECT_EQ(number(0, taken), expected);
        EXPECT_EQ(number(2, taken), expected);
    }
}

}  // namespace
}  // namespace atrium::record
