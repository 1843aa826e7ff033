#include "viewer/receive/stale_frames.hpp"

#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using std::chrono::milliseconds;

constexpr auto kFramePeriod = milliseconds(33);
const Timestamp kFirstCapture{1'000'000'000'000'000'000};

class StaleFramesTest : public testing::Test {
protected:
    StaleFrames sut_;
    Timestamp now_ = kFirstCapture;

    // Feeds frames in time, each `delay` after its capture. Returns the number judged as held up.
    int stream(std::chrono::nanoseconds delay, std::chrono::nanoseconds length) {
        int num_held_up = 0;
        for (const Timestamp end = now_ + length; now_ < end; now_ = now_ + kFramePeriod)
            num_held_up += sut_.add("site", now_ + -delay, now_);
        return num_held_up;
    }
};

TEST_F(StaleFramesTest, AcceptsEveryFrameWhateverTheClocks) {
    EXPECT_EQ(stream(milliseconds(20), std::chrono::seconds(5)), 0);
    StaleFrames other;
    for (int i = 0; i < 100; ++i)
        EXPECT_FALSE(other.add("ahead",
                               kFirstCapture + std::chrono::seconds(3600) + i * kFramePeriod,
                               kFirstCapture + i * kFramePeriod));
}

TEST_F(StaleFramesTest, FindsFramesQueuedWhileAProgramWasStopped) {
    stream(milliseconds(20), std::chrono::seconds(5));
    const Timestamp stopped = now_;
    now_ = now_ + std::chrono::seconds(5);
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(sut_.add("site", stopped + i * kFramePeriod, now_));
    EXPECT_EQ(stream(milliseconds(20), std::chrono::seconds(1)), 0);
}

TEST_F(StaleFramesTest, AcceptsAQueueBelowASecond) {
    stream(milliseconds(20), std::chrono::seconds(5));
    EXPECT_EQ(stream(milliseconds(900), std::chrono::seconds(2)), 0);
}

TEST_F(StaleFramesTest, AdaptsToAClockStepWithinHalfASecond) {
    stream(milliseconds(20), std::chrono::seconds(5));
    const int num = stream(std::chrono::seconds(10), std::chrono::seconds(5));
    EXPECT_GE(num, 14);
    EXPECT_LE(num, 17);
    // a frame earlier than all others is never late
    EXPECT_EQ(stream(std::chrono::seconds(-10), std::chrono::seconds(5)), 0);
    EXPECT_LE(stream(milliseconds(20), std::chrono::seconds(5)), 17);
}

TEST_F(StaleFramesTest, RefusesOldFramesBetweenNewOnes) {
    stream(milliseconds(20), std::chrono::seconds(5));
    for (int i = 0; i < 100; ++i) {
        EXPECT_TRUE(sut_.add("site", now_ + std::chrono::seconds(-3), now_));
        EXPECT_FALSE(sut_.add("site", now_ + milliseconds(-20), now_));
        now_ = now_ + kFramePeriod;
    }
}

// A drift of 50 ppm makes two seconds in eleven hours.
TEST_F(StaleFramesTest, FollowsClockDrift) {
    int num_held_up = 0;
    for (int minute = 0; minute < 660; ++minute) {
        for (int i = 0; i < 3; ++i) {
            const auto drift = minute * milliseconds(3);
            num_held_up += sut_.add("site", now_ + -(milliseconds(20) + drift), now_);
            now_ = now_ + std::chrono::seconds(20);
        }
    }
    EXPECT_EQ(num_held_up, 0);
}

TEST_F(StaleFramesTest, RestartsForASiteThatReturns) {
    stream(milliseconds(20), std::chrono::seconds(1));
    sut_.forget("site");
    EXPECT_EQ(stream(std::chrono::seconds(8), std::chrono::seconds(1)), 0);
}

}  // namespace
}  // namespace atrium::viewer
