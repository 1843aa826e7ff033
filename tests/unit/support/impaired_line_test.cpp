#include "tests/support/network/impaired_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <vector>

namespace atrium::test {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kMs = 1'000'000;

ImpairedLine line_with(const Impairment& impairment, std::uint64_t seed = 1) {
    ImpairedLine line(seed);
    line.set(impairment);
    return line;
}

// The lost ones among `num` packets, sent one per millisecond.
std::vector<bool> losses(const Impairment& impairment, std::uint64_t seed, int num = 100'000) {
    ImpairedLine line = line_with(impairment, seed);
    std::vector<bool> lost;
    for (int i = 0; i < num; ++i) lost.push_back(line.enter(i * kMs, 100).fate == Fate::kLost);
    return lost;
}

double share(const std::vector<bool>& lost) {
    return static_cast<double>(std::count(lost.begin(), lost.end(), true)) /
           static_cast<double>(lost.size());
}

TEST(ImpairedLine, DoesNothingByDefault) {
    ImpairedLine line(1);
    for (int i = 0; i < 1000; ++i) {
        const Passage passage = line.enter(i, 1500);
        EXPECT_EQ(passage.fate, Fate::kPasses);
        EXPECT_EQ(passage.leaves_ns, i);
        EXPECT_FALSE(passage.twice);
    }
}

TEST(ImpairedLine, DelaysByTheConfiguredTime) {
    ImpairedLine line = line_with({.delay = 50ms});
    EXPECT_EQ(line.enter(7, 100).leaves_ns, 50 * kMs + 7);
}

TEST(ImpairedLine, JitterUsesItsRangeWithoutReordering) {
    ImpairedLine line = line_with({.delay = 50ms, .jitter = 10ms});
    std::int64_t last_ns = 0;
    double sum_ms = 0;
    double least_ms = 1e9;
    double most_ms = 0;
    constexpr int kNum = 200'000;
    for (int i = 0; i < kNum; ++i) {
        const std::int64_t now_ns = i * kMs / 4;
        const std::int64_t leaves_ns = line.enter(now_ns, 100).leaves_ns;
        EXPECT_GE(leaves_ns, last_ns);
        last_ns = leaves_ns;
        const double delay_ms = static_cast<double>(leaves_ns - now_ns) / kMs;
        least_ms = std::min(least_ms, delay_ms);
        most_ms = std::max(most_ms, delay_ms);
        sum_ms += delay_ms;
    }
    EXPECT_GE(least_ms, 40.0);
    EXPECT_LE(most_ms, 60.0);
    EXPECT_LT(least_ms, 41.0);
    EXPECT_GT(most_ms, 59.0);
    // 1250 values with a standard deviation of 10/sqrt(3) ms each: 4 sigma
    EXPECT_NEAR(sum_ms / kNum, 50.0, 4 * 10 / std::sqrt(3 * 1250.0));
}

TEST(ImpairedLine, LosesTheConfiguredShare) {
    // 4 sigma of a binomial share
    EXPECT_NEAR(share(losses({.loss = 0.05}, 3)), 0.05, 4 * std::sqrt(0.05 * 0.95 / 100'000));
    EXPECT_EQ(share(losses({.loss = 0.0}, 3)), 0.0);
    EXPECT_EQ(share(losses({.loss = 1.0}, 3)), 1.0);
}

TEST(ImpairedLine, LosesTheSamePacketsAtAnyRateAndDelay) {
    const Impairment plain{.loss = 0.05, .burst_start = 0.01, .burst_length = 4};
    EXPECT_EQ(losses(plain, 3), losses(plain, 3));
    EXPECT_NE(losses(plain, 3), losses(plain, 4));
    Impairment other = plain;
    other.delay = 30ms;
    other.jitter = 20ms;
    other.duplicated = 0.5;
    other.held_back = 0.5;
    other.rate_bit_per_s = 1e9;
    EXPECT_EQ(losses(plain, 3), losses(other, 3));
}

TEST(ImpairedLine, LosesBurstsOfTheConfiguredLength) {
    const double start = 0.004;
    const double length = 5.0;
    const std::vector<bool> lost =
        losses({.burst_start = start, .burst_length = length}, 5, 1'000'000);
    int num_rows = 0;
    for (std::size_t i = 1; i < lost.size(); ++i) num_rows += lost[i] && !lost[i - 1] ? 1 : 0;
    const double mean_length = share(lost) * static_cast<double>(lost.size()) / num_rows;
    // burst lengths are geometric, with deviation sqrt(length * (length - 1)); 4 sigma
    EXPECT_NEAR(mean_length, length, 4 * std::sqrt(length * (length - 1) / num_rows));
    EXPECT_NEAR(share(lost), start * length / (1 + start * length), 0.001);
}

TEST(ImpairedLine, KeepsTheRateAndDropsPacketsBeyondTheQueue) {
    // 1250 bytes at 10 Mbit/s take 1 ms; the test sends twice as many
    ImpairedLine line = line_with({.rate_bit_per_s = 10e6, .queue = 20ms});
    std::vector<std::int64_t> leaves_ns;
    for (int i = 0; i < 2000; ++i) {
        const Passage passage = line.enter(i * kMs / 2, 1250);
        if (passage.fate == Fate::kPasses) leaves_ns.push_back(passage.leaves_ns);
    }
    for (std::size_t i = 1; i < leaves_ns.size(); ++i)
        ASSERT_EQ(leaves_ns[i] - leaves_ns[i - 1], kMs);
    const LineCounters& counters = line.counters();
    EXPECT_EQ(leaves_ns.front(), kMs);
    // 1000 in one second, plus those that wait at its end
    EXPECT_NEAR(static_cast<double>(leaves_ns.size()), 1000 + 20, 2);
    EXPECT_EQ(counters.dropped_by_queue, 2000 - leaves_ns.size());
    EXPECT_LE(counters.longest_queue, 20ms);
    EXPECT_GT(counters.longest_queue, 19ms);
}

TEST(ImpairedLine, QueuesNothingWithoutALimit) {
    ImpairedLine line = line_with({.queue = 0ms});
    for (int i = 0; i < 100; ++i) EXPECT_EQ(line.enter(0, 1500).leaves_ns, 0);
    EXPECT_EQ(line.counters().longest_queue, 0ns);
}

TEST(ImpairedLine, KeepsTheOrderWhenTheDelayShrinks) {
    ImpairedLine line = line_with({.delay = 50ms});
    EXPECT_EQ(line.enter(0, 100).leaves_ns, 50 * kMs);
    line.set({.delay = 1ms});
    EXPECT_EQ(line.enter(kMs, 100).leaves_ns, 50 * kMs);
    EXPECT_EQ(line.enter(60 * kMs, 100).leaves_ns, 61 * kMs);
}

TEST(ImpairedLine, ReordersOnlyPacketsHeldBack) {
    ImpairedLine line = line_with({.delay = 5ms, .held_back = 0.1, .held_back_by = 8ms});
    int num_held = 0;
    for (int i = 0; i < 10'000; ++i) {
        const std::int64_t delay_ns = line.enter(i * kMs, 100).leaves_ns - i * kMs;
        EXPECT_TRUE(delay_ns == 5 * kMs || delay_ns == 13 * kMs);
        num_held += delay_ns == 13 * kMs ? 1 : 0;
    }
    EXPECT_NEAR(num_held, 1000, 4 * std::sqrt(10'000 * 0.1 * 0.9));
}

TEST(ImpairedLine, CutStopsNewPacketsUntilTheRestore) {
    ImpairedLine line = line_with({.delay = 5ms});
    EXPECT_EQ(line.enter(0, 100).fate, Fate::kPasses);
    line.cut();
    EXPECT_EQ(line.enter(1, 100).fate, Fate::kCut);
    EXPECT_EQ(line.enter(2, 100).fate, Fate::kCut);
    line.restore();
    EXPECT_EQ(line.enter(3, 100).leaves_ns, 5 * kMs + 3);
    EXPECT_EQ(line.counters().dropped_by_cut, 2u);
}

TEST(ImpairedLine, CountersAddUp) {
    ImpairedLine line = line_with(
        {.delay = 5ms, .loss = 0.1, .rate_bit_per_s = 10e6, .queue = 5ms, .duplicated = 0.2});
    std::uint64_t num_out = 0;
    for (int i = 0; i < 10'000; ++i) {
        if (i == 5000) line.cut();
        if (i == 6000) line.restore();
        const Passage passage = line.enter(i * kMs / 2, 1250);
        if (passage.fate != Fate::kPasses) continue;
        num_out += passage.twice ? 2 : 1;
        EXPECT_GT(line.counters().in_flight(), 0u);
        for (int copy = 0; copy < (passage.twice ? 2 : 1); ++copy) line.note_left(1250);
    }
    const LineCounters& counters = line.counters();
    EXPECT_EQ(counters.in_flight(), 0u);
    EXPECT_EQ(counters.entered, 10'000u);
    EXPECT_EQ(counters.entered_bytes, 12'500'000u);
    EXPECT_EQ(counters.dropped_by_cut, 1000u);
    EXPECT_EQ(counters.left, num_out);
    EXPECT_EQ(counters.left_bytes, 1250 * num_out);
    EXPECT_GT(counters.lost, 0u);
    EXPECT_GT(counters.duplicated, 0u);
    EXPECT_GT(counters.dropped_by_queue, 0u);
}

}  // namespace
}  // namespace atrium::test
