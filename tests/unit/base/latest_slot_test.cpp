#include "core/base/latest_slot.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace atrium {
namespace {

TEST(LatestSlot, IsEmptyAtFirst) {
    LatestSlot<int> slot;
    EXPECT_FALSE(slot.try_take().has_value());
    EXPECT_EQ(slot.num_dropped(), 0u);
}

TEST(LatestSlot, KeepsTheNewestAndCountsReplacedValues) {
    LatestSlot<int> slot;
    EXPECT_FALSE(slot.put(1));
    EXPECT_TRUE(slot.put(2));
    EXPECT_TRUE(slot.put(3));
    EXPECT_EQ(slot.try_take(), 3);
    EXPECT_FALSE(slot.try_take().has_value());
    EXPECT_EQ(slot.num_dropped(), 2u);
}

TEST(LatestSlot, TakeReturnsWhenStopIsRequested) {
    LatestSlot<int> slot;
    std::optional<int> result = 7;
    {
        std::jthread taker([&](std::stop_token stop) { result = slot.take(stop); });
    }  // requests the stop and joins
    EXPECT_FALSE(result.has_value());
}

TEST(LatestSlot, ReturnsWithoutAValueAtTheDeadline) {
    LatestSlot<int> slot;
    const auto past = std::chrono::steady_clock::now();
    EXPECT_FALSE(slot.take_until({}, past).has_value());
    slot.put(3);
    EXPECT_EQ(slot.take_until({}, past), 3);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_FALSE(slot.take_until(stop.get_token(), past + std::chrono::hours(1)).has_value());
}

TEST(LatestSlot, KeepsOrderAndCountsEveryLossUnderContention) {
    constexpr int kNumValues = 20000;
    LatestSlot<int> slot;
    int num_taken = 0;
    int last = 0;
    bool in_order = true;
    std::jthread taker([&](std::stop_token stop) {
        while (const auto value = slot.take(stop)) {
            in_order = in_order && *value > last;
            last = *value;
            ++num_taken;
            if (last == kNumValues) return;
        }
    });
    for (int i = 1; i <= kNumValues; ++i) slot.put(i);
    taker.join();
    EXPECT_TRUE(in_order);
    EXPECT_EQ(last, kNumValues);
    EXPECT_EQ(static_cast<std::uint64_t>(num_taken) + slot.num_dropped(),
              static_cast<std::uint64_t>(kNumValues));
}

}  // namespace
}  // namespace atrium
