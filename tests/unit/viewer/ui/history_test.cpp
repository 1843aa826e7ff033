#include "viewer/ui/history.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace atrium::viewer {
namespace {

using std::chrono::milliseconds;

const History::Clock::time_point kFirstValue{std::chrono::hours(1)};

TEST(History, HasMeansAndRatesOfTheLastHalfMinute) {
    History history;
    History pictures;
    auto now = kFirstValue;
    for (int i = 0; i < 60 * 40; ++i, now += milliseconds(16) + std::chrono::microseconds(667)) {
        const bool is_late = now - kFirstValue > std::chrono::seconds(30);
        history.add(is_late ? 80.0 : 40.0, now);
        pictures.add(1.0, now);
    }
    const auto means = history.values(History::Of::kMean, now);
    EXPECT_EQ(means.size(), 119U);
    EXPECT_NEAR(means.front(), 40.0F, 1e-3);
    EXPECT_NEAR(means.back(), 80.0F, 1e-3);
    EXPECT_NEAR(static_cast<double>(std::ranges::count(means, 80.0F)), 40.0, 1.0);
    for (const float rate : pictures.values(History::Of::kPerSecond, now)) EXPECT_NEAR(rate, 60, 5);
    const auto later = history.values(History::Of::kMean, now + std::chrono::seconds(20));
    EXPECT_EQ(later.back(), 0.0F) << "nothing arrived since";
    EXPECT_NEAR(later.front(), 80.0F, 80.0F) << "older values must be gone";
}

}  // namespace
}  // namespace atrium::viewer
