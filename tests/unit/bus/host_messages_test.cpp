#include "core/bus/limits.hpp"
#include "core/bus/messages.hpp"

#include <gtest/gtest.h>

#include <random>

namespace atrium::bus {
namespace {

TEST(SiteOrders, WithoutAnyEveryTextureIsWanted) {
    EXPECT_TRUE(is_texture_wanted({}, {5}));
    EXPECT_TRUE(is_texture_wanted({}, {-5}));
}

// Whatever the host's clock, within half a period: one of `send_every` instants, the right one.
TEST(SiteOrders, OneOfSoManyInstantsIsWanted) {
    std::mt19937_64 random(3);
    constexpr std::int64_t kPeriod_ns = 33'333'333;
    for (std::uint32_t every = 2; every <= kMaxSendEvery; ++every) {
        SiteOrders orders;
        orders.send_every = every;
        orders.sent = {1'700'000'000'000'000'000};
        orders.period = std::chrono::nanoseconds(kPeriod_ns);
        for (std::int64_t instant = -100; instant < 100; ++instant) {
            std::uniform_int_distribution<std::int64_t> off_ns(-kPeriod_ns * 45 / 100,
                                                               kPeriod_ns * 45 / 100);
            const Timestamp time{orders.sent.ns + instant * kPeriod_ns + off_ns(random)};
            EXPECT_EQ(is_texture_wanted(orders, time), instant % every == 0)
                << every << " " << instant;
        }
    }
}

TEST(SiteOrders, ExtremeTimesDoNoHarm) {
    SiteOrders orders;
    orders.send_every = 2;
    for (const std::int64_t sent : {std::int64_t{0}, kMaxTime_ns}) {
        for (const std::int64_t period : {std::int64_t{0}, kMaxTime_ns}) {
            orders.sent = {sent};
            orders.period = std::chrono::nanoseconds(period);
            for (const std::int64_t time : {std::int64_t{0}, kMaxTime_ns})
                is_texture_wanted(orders, {time});
        }
    }
}

}  // namespace
}  // namespace atrium::bus
