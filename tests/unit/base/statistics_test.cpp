#include "core/base/statistics.hpp"

#include <gtest/gtest.h>

namespace atrium {
namespace {

using std::chrono::milliseconds;

TEST(LatencyWindow, ReportsNothingWithoutMeasurements) {
    EXPECT_EQ(LatencyWindow().quantiles().num_samples, 0u);
}

TEST(LatencyWindow, GivesNearestRankQuantiles) {
    LatencyWindow window(200);
    for (int ms = 100; ms >= 1; --ms) window.add(milliseconds(ms));
    const Quantiles q = window.quantiles();
    EXPECT_DOUBLE_EQ(q.median_ms, 50.0);
    EXPECT_DOUBLE_EQ(q.p99_ms, 99.0);
    EXPECT_EQ(q.num_samples, 100u);
}

TEST(LatencyWindow, ForgetsTheOldestValues) {
    LatencyWindow window(3);
    for (const int ms : {1000, 1, 2, 3}) window.add(milliseconds(ms));
    EXPECT_DOUBLE_EQ(window.quantiles().p99_ms, 3.0);
}

TEST(RateMeter, DividesTheCountDifferenceByTheTime) {
    const auto t0 = std::chrono::steady_clock::time_point{} + milliseconds(5);
    RateMeter meter;
    EXPECT_DOUBLE_EQ(meter.update(10, t0), 0.0);
    EXPECT_DOUBLE_EQ(meter.update(40, t0 + milliseconds(1500)), 20.0);
    EXPECT_DOUBLE_EQ(meter.update(40, t0 + milliseconds(2500)), 0.0);
}

}  // namespace
}  // namespace atrium
