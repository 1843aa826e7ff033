#include "world_server/pace.hpp"

#include <gtest/gtest.h>

namespace atrium::world_server {
namespace {

using namespace std::chrono_literals;
constexpr Pace::Clock::time_point kStart{1h};

TEST(Pace, GivesOneTickPerPeriod) {
    Pace pace(10ms, 4, kStart);
    EXPECT_EQ(pace.num_due(kStart), 0);
    EXPECT_EQ(pace.num_due(kStart + 9ms), 0);
    EXPECT_EQ(pace.num_due(kStart + 10ms), 1);
    EXPECT_EQ(pace.num_due(kStart + 19ms), 0);
    EXPECT_EQ(pace.next(), kStart + 20ms);
    EXPECT_EQ(pace.num_due(kStart + 45ms), 3);
    EXPECT_EQ(pace.num_skipped(), 0U);
}

TEST(Pace, SkipsAndCountsTicksItCannotCatchUp) {
    Pace pace(10ms, 4, kStart);
    EXPECT_EQ(pace.num_due(kStart + 1005ms), 4);
    EXPECT_EQ(pace.num_skipped(), 96U);
    EXPECT_EQ(pace.num_due(kStart + 1009ms), 0) << "no tick must remain due";
    EXPECT_EQ(pace.num_due(kStart + 1010ms), 1);
}

TEST(Pace, StopEndsSleepAtOnce) {
    std::stop_source source;
    source.request_stop();
    const auto before = Pace::Clock::now();
    sleep_until(before + 1h, source.get_token());
    EXPECT_LT(Pace::Clock::now() - before, 10s);
}

}  // namespace
}  // namespace atrium::world_server
