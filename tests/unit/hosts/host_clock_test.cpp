#include "site_node/hosts/host_clock.hpp"

#include <gtest/gtest.h>

#include <random>

namespace atrium::hosts {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr Timestamp kStart{1'700'000'000'000'000'000};

class HostClockUnderDelays : public testing::TestWithParam<int> {};

TEST_P(HostClockUnderDelays, NeverErrsByMoreThanItSays) {
    std::mt19937_64 random(static_cast<unsigned>(GetParam()));
    const auto between = [&](double low, double high) {
        return nanoseconds(
            static_cast<std::int64_t>(std::uniform_real_distribution<>(low, high)(random)));
    };
    const nanoseconds offset = between(-1e8, 1e8);
    const double drift = std::uniform_real_distribution<>(-5e-4, 5e-4)(random);
    const double slow_there = std::uniform_real_distribution<>(0.0, 1e7)(random);
    const double slow_back = std::uniform_real_distribution<>(0.0, 1e7)(random);
    const auto other_clock = [&](Timestamp now) {
        return now + offset +
               nanoseconds(
                   static_cast<std::int64_t>(drift * static_cast<double>((now - kStart).count())));
    };
    HostClock sut;
    HostClock::Time steady{};
    Timestamp now = kStart;
    EXPECT_FALSE(sut.estimate(steady));
    for (int question = 0; question < 200; ++question) {
        const Timestamp received = now + between(1e5, 1e6 + slow_there);
        const Timestamp answered = received + between(1e4, 1e6);
        const Timestamp returned = answered + between(1e5, 1e6 + slow_back);
        steady += returned - now;
        sut.add({now, other_clock(received), other_clock(answered), returned}, steady);
        now = returned;
        const auto estimate = sut.estimate(steady);
        ASSERT_TRUE(estimate);
        const nanoseconds truth = other_clock(now) - now;
        ASSERT_LE(std::chrono::abs(estimate->offset - truth), estimate->error);
        const auto pause = between(1e7, 3e8);
        now = now + pause;
        steady += pause;
    }
    // the best way there and back takes less than 4 ms of the 22 that are possible
    EXPECT_LT(sut.estimate(steady)->error, milliseconds(6));
    EXPECT_FALSE(sut.estimate(steady + HostClock::kLongestAge + milliseconds(400)));
}
INSTANTIATE_TEST_SUITE_P(Seeds, HostClockUnderDelays, testing::Range(0, 100));

TEST(HostClock, IgnoresImpossibleAnswers) {
    HostClock sut;
    const HostClock::Time now{};
    sut.add({{5}, {10}, {20}, {4}}, now);   // back before it was asked
    sut.add({{5}, {20}, {10}, {40}}, now);  // answered before it arrived
    sut.add({{5}, {10}, {90}, {40}}, now);  // thought about for longer than it took
    EXPECT_FALSE(sut.estimate(now));
    sut.add({{5}, {10}, {10}, {40}}, now);
    EXPECT_TRUE(sut.estimate(now));
}

// Ways of 1 ms there and 9 ms back, and of 9 ms there and 1 ms back: the offset is 0.
TEST(HostClock, ShortestWaysOfDifferentAnswersCountTogether) {
    const auto at = [](int ms) { return kStart + milliseconds(ms); };
    HostClock sut;
    const HostClock::Time now{};
    sut.add({at(0), at(1), at(1), at(10)}, now);
    EXPECT_LE(sut.estimate(now)->error, milliseconds(5) + nanoseconds(2));
    EXPECT_GE(sut.estimate(now)->error, milliseconds(5));
    sut.add({at(100), at(109), at(109), at(110)}, now);
    EXPECT_LE(sut.estimate(now)->error, milliseconds(1) + nanoseconds(2));
    EXPECT_GE(sut.estimate(now)->error, milliseconds(1));
    EXPECT_LE(std::chrono::abs(sut.estimate(now)->offset), nanoseconds(2));
}

// A clock may be set by less than begins an epoch: then the quickest answer counts.
TEST(HostClock, OfAnswersThatContradictEachOtherTheQuickestCounts) {
    const auto at_us = [](int us) { return kStart + std::chrono::microseconds(us); };
    HostClock sut;
    const HostClock::Time now{};
    sut.add({at_us(0), at_us(100), at_us(100), at_us(200)}, now);
    sut.add({at_us(1000), at_us(1000 + 90 + 700), at_us(1000 + 90 + 700), at_us(1000 + 180)}, now);
    EXPECT_EQ(sut.estimate(now)->offset, std::chrono::microseconds(700));
    EXPECT_LE(sut.estimate(now)->error, std::chrono::microseconds(91));
}

}  // namespace
}  // namespace atrium::hosts
