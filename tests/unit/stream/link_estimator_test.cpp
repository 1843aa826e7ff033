#include "site_node/stream/link_estimator.hpp"

#include "time_at.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace atrium::stream {
namespace {

LinkReport report(double bit_per_s, double delay_ms) {
    return {6, 0, 54, bit_per_s, delay_ms, delay_ms};
}

/// Feeds five reports a second, with the delay as a function of time.
class Estimated : public testing::Test {
protected:
    using Delay = std::function<double(double)>;
    void run(double seconds, double bit_per_s, const Delay& delay_ms, double next_bit_per_s = 0.0) {
        for (const double end_s = now_s_ + seconds; now_s_ < end_s - 1e-9; now_s_ += 0.2)
            estimator_.add(report(bit_per_s, delay_ms(now_s_)), next_bit_per_s, at(now_s_));
    }
    bool has_no_limit() const { return estimator_.bit_per_s() == LinkEstimator::kNoLimit; }

    LinkEstimator estimator_{report(20e6, 30.0), 2e6, at(0.0)};
    double now_s_ = 0.2;
};

TEST_F(Estimated, HasNoLimitWithoutAQueue) {
    run(
        60.0, 30e6, [](double) { return 30.0; }, 40e6);
    EXPECT_TRUE(has_no_limit());
    EXPECT_EQ(estimator_.paced_bit_per_s(), LinkEstimator::kNoLimit);
}

TEST_F(Estimated, FallsBelowTheArrivingRateAndDrainsTheQueue) {
    run(2.0, 20e6, [](double) { return 30.0; });
    run(0.2, 20e6, [](double) { return 60.0; });
    run(0.2, 20e6, [](double) { return 90.0; });
    EXPECT_DOUBLE_EQ(estimator_.bit_per_s(), 0.85 * 20e6);
    EXPECT_LT(estimator_.paced_bit_per_s(), estimator_.bit_per_s());
    EXPECT_NEAR(estimator_.queue_ms(), 60.0, 1e-6);
    run(0.4, 12e6, [](double) { return 32.0; });
    EXPECT_DOUBLE_EQ(estimator_.paced_bit_per_s(), estimator_.bit_per_s());
}

TEST_F(Estimated, GrowsSlowlyNearTheRateOfTheLastQueueAndOnlyWithoutOne) {
    run(2.0, 20e6, [](double) { return 30.0; });
    run(0.4, 20e6, [](double) { return 100.0; });
    run(0.4, 17e6, [](double) { return 30.0; });
    const double lowered = estimator_.bit_per_s();
    run(
        1.0, 17e6, [](double) { return 30.0; }, 30e6);
    EXPECT_NEAR(estimator_.bit_per_s() / lowered, 1.065, 0.015);
    const auto queue = [](double) { return 50.0; };
    run(0.2, 17e6, queue, 30e6);  // a single report may be chance
    const double held = estimator_.bit_per_s();
    run(0.2, 17e6, queue, 30e6);
    EXPECT_LE(estimator_.bit_per_s(), held);
}

TEST_F(Estimated, LosesItsLimitAfterEnoughTimeWithRoom) {
    run(2.0, 20e6, [](double) { return 30.0; });
    run(0.4, 20e6, [](double) { return 100.0; });
    run(
        15.0, 10e6, [](double) { return 30.0; }, 0.0);
    EXPECT_TRUE(has_no_limit());
}

TEST_F(Estimated, ToleratesClockOffsetsAndFollowsDrift) {
    for (const double offset_ms : {-3.6e6, 0.0, 3.6e6}) {
        for (const double drift_ms_per_s : {-0.2, 0.2}) {
            estimator_ = LinkEstimator(report(20e6, offset_ms), 2e6, at(0.0));
            now_s_ = 0.2;
            const auto delay = [&](double t) { return offset_ms + drift_ms_per_s * t; };
            run(300.0, 20e6, delay);
            EXPECT_TRUE(has_no_limit()) << offset_ms << " " << drift_ms_per_s;
            run(0.6, 20e6, [&](double t) { return delay(t) + 70.0; });
            EXPECT_FALSE(has_no_limit()) << offset_ms << " " << drift_ms_per_s;
        }
    }
}

TEST_F(Estimated, ClockStepIsNoQueue) {
    run(5.0, 20e6, [](double) { return 30.0; });
    run(5.0, 20e6, [](double) { return 1030.0; });
    EXPECT_TRUE(has_no_limit());
    run(5.0, 20e6, [](double) { return -5000.0; });
    EXPECT_TRUE(has_no_limit());
    run(0.6, 20e6, [](double) { return -4900.0; });
    EXPECT_FALSE(has_no_limit()) << "a queue after the clock step must be found";
}

// Another route, or a small clock step. It looks like a queue, but does not go away.
TEST_F(Estimated, LongerPathLooksLikeAQueueForSomeSecondsOnly) {
    run(5.0, 20e6, [](double) { return 30.0; });
    run(6.0, 20e6, [](double) { return 110.0; });
    EXPECT_TRUE(has_no_limit());
    EXPECT_LT(estimator_.queue_ms(), 1.0);
}

TEST_F(Estimated, EmptyReportChangesNothing) {
    run(5.0, 20e6, [](double) { return 30.0; });
    for (int i = 0; i < 20; ++i) estimator_.add({}, 0.0, at(now_s_ += 0.2));
    EXPECT_TRUE(has_no_limit());
    run(1.0, 20e6, [](double) { return 30.0; });
    EXPECT_TRUE(has_no_limit());
}

TEST_F(Estimated, FallsForIncompleteFrames) {
    run(2.0, 20e6, [](double) { return 30.0; });
    for (int i = 0; i < 5; ++i)
        estimator_.add({3, 3, 40, 18e6, 30.0, 30.0}, 0.0, at(now_s_ += 0.2));
    EXPECT_LE(estimator_.bit_per_s(), 0.9 * 18e6);
}

TEST_F(Estimated, WaitInTheViewersHostIsNoQueue) {
    run(2.0, 20e6, [](double) { return 30.0; });
    for (int i = 0; i < 1500; ++i) {
        const double wait_ms = 7.0 * (i % 60);
        estimator_.add({6, 0, 54, 20e6, 30.0 + wait_ms, 30.0, wait_ms}, 0.0, at(now_s_ += 0.2));
        ASSERT_TRUE(has_no_limit()) << i;
    }
}

TEST_F(Estimated, FindsAQueueBesideAWait) {
    run(2.0, 20e6, [](double) { return 30.0; });
    for (int i = 0; i < 2; ++i)
        estimator_.add({6, 0, 54, 5e6, 230.0, 80.0, 150.0}, 0.0, at(now_s_ += 0.2));
    EXPECT_DOUBLE_EQ(estimator_.bit_per_s(), 0.85 * 5e6);
}

TEST_F(Estimated, IgnoresIncompleteFramesAroundALongWait) {
    run(2.0, 20e6, [](double) { return 30.0; });
    for (int i = 0; i < 50; ++i) {
        const double wait_ms = i % 5 == 0 ? 300.0 : 5.0;
        estimator_.add({3, 3, 40, 18e6, 30.0, 30.0, wait_ms}, 0.0, at(now_s_ += 0.2));
    }
    EXPECT_TRUE(has_no_limit());
}

TEST_F(Estimated, RecoversFromIncompleteFramesThatNoRatePrevents) {
    run(2.0, 20e6, [](double) { return 30.0; });
    double least = LinkEstimator::kNoLimit;
    for (int i = 0; i < 300; ++i) {  // a minute
        estimator_.add({3, 3, 40, 18e6, 30.0, 30.0}, 0.0, at(now_s_ += 0.2));
        least = std::min(least, estimator_.bit_per_s());
    }
    EXPECT_GT(least, 0.6 * 18e6);
}

// The site sends its minimum whatever the link carries, so a queue stays there.
TEST_F(Estimated, PermanentQueueIsNotMistakenForThePath) {
    run(2.0, 0.5e6, [](double) { return 30.0; });
    run(20.0, 0.5e6, [](double) { return 330.0; });
    EXPECT_LE(estimator_.bit_per_s(), 0.5e6);
}

TEST_F(Estimated, RecoversFromNothing) {
    run(2.0, 20e6, [](double) { return 30.0; });
    for (int i = 0; i < 5; ++i)
        estimator_.add({0, 5, 9, 0.0, 200.0, 200.0}, 0.0, at(now_s_ += 0.2));
    ASSERT_LT(estimator_.bit_per_s(), 1.0);
    run(
        10.0, 2e6, [](double) { return 30.0; }, 30e6);
    EXPECT_GT(estimator_.bit_per_s(), 2e6);
}

TEST_F(Estimated, StaysFiniteForAnyReport) {
    const double numbers[] = {0.0, 1e15, -1e15, 1.0, 1e-300};
    std::uint32_t seed = 1;
    const auto pick = [&] { return numbers[(seed = seed * 1664525u + 1013904223u) >> 16 & 3u]; };
    for (int i = 0; i < 5000; ++i) {
        estimator_.add(
            {seed % 3, seed % 5, seed % 2, std::abs(pick()), pick(), pick(), std::abs(pick())},
            i % 2 == 0 ? 0.0 : 1e7,
            at(now_s_ += 0.2));
        ASSERT_FALSE(std::isnan(estimator_.bit_per_s()));
        ASSERT_FALSE(std::isnan(estimator_.paced_bit_per_s()));
        ASSERT_GE(estimator_.bit_per_s(), 0.0);
        ASSERT_GE(estimator_.paced_bit_per_s(), 0.0);
    }
}

TEST(DelayBaseTest, ForgetsAfterHalfAMinute) {
    DelayBase base;
    base.add(10.0, at(0.0));
    for (int i = 1; i <= 29; ++i) base.add(50.0, at(i));
    EXPECT_EQ(base.base_ms(), 10.0);
    base.add(50.0, at(31.0));
    EXPECT_EQ(base.base_ms(), 50.0);
    base.add(70.0, at(1e6));
    EXPECT_EQ(base.base_ms(), 70.0);
}

}  // namespace
}  // namespace atrium::stream
