#include "core/presence/clock_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::presence {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

constexpr Timestamp kNow{1'800'000'000'000'000'000};

TEST(ClockWatch, ReportsAClockAheadOnceWithItsOffset) {
    ClockWatch watch;
    const auto line = watch.see("beta", 1, kNow + 3200ms, kNow);
    ASSERT_TRUE(line);
    EXPECT_THAT(*line,
                AllOf(HasSubstr("host=beta"), HasSubstr("3.2 s ahead of"), HasSubstr("NTP")));
    EXPECT_FALSE(watch.see("beta", 1, kNow + 13200ms, kNow + 10s)) << "once";
    EXPECT_FALSE(watch.see("beta", 2, kNow + 13200ms, kNow + 10s)) << "once per host";
    EXPECT_TRUE(watch.see("gamma", 3, kNow + 1h, kNow));
}

TEST(ClockWatch, ReportsAClockBehindWhenNoSampleIsYoung) {
    ClockWatch watch;
    EXPECT_FALSE(watch.see("beta", 1, kNow + -60s, kNow));
    EXPECT_FALSE(watch.see("beta", 1, kNow + -55s, kNow + 5s));
    const auto line = watch.see("beta", 1, kNow + -45s, kNow + 14s);
    ASSERT_TRUE(line);
    EXPECT_THAT(*line, HasSubstr("59.0 s behind"));
}

TEST(ClockWatch, AcceptsOldSamplesAndSlowNetworks) {
    ClockWatch watch;
    // waited in the writer's history until this program joined
    EXPECT_FALSE(watch.see("beta", 1, kNow + -9s, kNow));
    for (int i = 1; i < 20; ++i) {
        const auto now = kNow + std::chrono::seconds(10 * i);
        EXPECT_FALSE(watch.see("beta", 1, now + -1500ms, now)) << i;
        EXPECT_FALSE(watch.see("gamma", 2, now + 90ms, now)) << i;
    }
    // each program's first sample may be old
    for (std::uint64_t program = 10; program < 20; ++program)
        EXPECT_FALSE(watch.see("delta", program, kNow + -9s, kNow)) << program;
}

TEST(ClockWatch, RemembersABoundedNumberOfHosts) {
    ClockWatch watch;
    int num_reported = 0;
    for (int i = 0; i < 1000; ++i)
        num_reported += watch.see("host" + std::to_string(i), 1, kNow + 1h, kNow) ? 1 : 0;
    EXPECT_EQ(num_reported, 256);
}

}  // namespace
}  // namespace atrium::presence
