// The whole of site_node/stream with the viewer's counters, on simulated networks.
#include "tests/support/network/simulated_stream.hpp"

#include <gtest/gtest.h>

#include <random>

namespace atrium::test {
namespace {

constexpr double kMega = 1e6;

SimulatedLink link_of(double mbit_per_s) {
    SimulatedLink link;
    link.bit_per_s = [=](double) { return kMega * mbit_per_s; };
    return link;
}

SimulatedSite site_of(std::uint64_t seed, const stream::StreamOptions& options = {}) {
    SimulatedSite site;
    site.seed = seed;
    site.options = options;
    return site;
}

// Time that a frame needs to pass the link by itself at the sent rate. It is part of the link's
// delay, not of a queue.
double way_ms(const SimulatedLink& link, const StreamRecord& record, double from_s, double to_s) {
    double largest = 0.0;
    for (const SentFrame& frame : record.sent) {
        if (frame.time_s >= from_s && frame.time_s < to_s) largest = std::max(largest, frame.bytes);
    }
    return link.delay_ms + 1e3 * 8.0 * largest / link.bit_per_s(from_s);
}

class NarrowLink : public testing::TestWithParam<double> {};

TEST_P(NarrowLink, IsUsedWithoutAQueue) {
    const SimulatedLink link = link_of(GetParam());
    const StreamRecord record = simulate({}, {link}, 120.0);
    const ViewerRecord& viewer = record.viewers[0];
    EXPECT_LT(max_age_ms(viewer, 2.0, 120.0), way_ms(link, record, 2.0, 120.0) + 100.0);
    EXPECT_LT(median_age_ms(viewer, 2.0, 120.0), way_ms(link, record, 2.0, 120.0) + 20.0);
    EXPECT_GE(carried_bit_per_s(viewer, 2.0, 120.0), 0.7 * kMega * GetParam());
    EXPECT_LE(num_steps(record, 2.0, 120.0), 2 * 24);
}
INSTANTIATE_TEST_SUITE_P(Mbit, NarrowLink, testing::Values(5.0, 10.0, 20.0));

TEST(WidenedLink, RegainsItsQualitySoon) {
    for (const double narrow : {5.0, 10.0, 20.0}) {
        SimulatedLink link;
        link.bit_per_s = [=](double t) { return t < 30.0 ? kMega * narrow : 1e9; };
        const StreamRecord record = simulate({}, {link}, 60.0);
        double back_s = 0.0;
        for (const Step& step : record.steps) {
            if (step.to == 0) back_s = step.time_s;
        }
        ASSERT_GT(back_s, 30.0) << narrow;
        EXPECT_LT(back_s, narrow < 10.0 ? 48.0 : 45.0) << narrow;
        EXPECT_EQ(num_steps(record, back_s + 0.1, 60.0), 0) << narrow;
    }
}

TEST(SuddenlyNarrowLink, IsFreeOfItsQueueAfterTwoSeconds) {
    for (const double narrow : {5.0, 10.0, 20.0}) {
        SimulatedLink link;
        link.bit_per_s = [=](double t) { return t < 10.0 ? 1e9 : kMega * narrow; };
        const StreamRecord record = simulate({}, {link}, 30.0);
        EXPECT_LT(max_age_ms(record.viewers[0], 12.0, 30.0),
                  way_ms(link, record, 12.0, 30.0) + 100.0)
            << narrow;
        EXPECT_EQ(num_steps(record, 0.0, 10.0), 0);
    }
}

TEST(WideLink, DoesNotReactToLossAndJitter) {
    for (const double loss : {0.01, 0.02, 0.05}) {
        for (const std::uint64_t seed : {1, 2, 3}) {
            SimulatedLink link;
            link.loss = loss;
            link.jitter_ms = 10.0;
            const StreamRecord record = simulate(site_of(seed), {link}, 120.0);
            EXPECT_EQ(record.steps.size(), 0u) << loss << " seed " << seed;
            EXPECT_NEAR(static_cast<double>(record.viewers[0].arrived.size()), 3600.0, 10.0);
        }
    }
}

TEST(WideLink, DoesNotReactToLossThatBeginsLater) {
    SimulatedLink link;
    link.jitter_ms = 10.0;
    SimulatedLink lossy = link;
    lossy.viewer = "v2";
    lossy.loss = 0.03;
    lossy.is_paused = [](double t) { return t < 40.0; };
    EXPECT_EQ(simulate({}, {link, lossy}, 100.0).steps.size(), 0u);
}

TEST(NarrowLossyLink, IsUsedDespiteLoss) {
    SimulatedLink link = link_of(10.0);
    link.loss = 0.02;
    link.jitter_ms = 10.0;
    const StreamRecord record = simulate({}, {link}, 120.0);
    EXPECT_GE(carried_bit_per_s(record.viewers[0], 2.0, 120.0), 0.7 * 10.0 * kMega);
    EXPECT_LT(max_age_ms(record.viewers[0], 2.0, 120.0),
              way_ms(link, record, 2.0, 120.0) + 2.1 * link.delay_ms + 100.0);
}

TEST(Clocks, NeitherOffsetNorDriftMatters) {
    const StreamRecord same = simulate({}, {link_of(10.0)}, 60.0);
    SimulatedLink link = link_of(10.0);
    link.clock_offset_ms = [](double t) { return 7.2e6 - 0.1 * t; };
    const StreamRecord other = simulate({}, {link}, 60.0);
    EXPECT_NEAR(carried_bit_per_s(other.viewers[0], 2.0, 60.0),
                carried_bit_per_s(same.viewers[0], 2.0, 60.0),
                0.1 * 10.0 * kMega);
    EXPECT_LT(max_age_ms(other.viewers[0], 2.0, 60.0), way_ms(link, other, 2.0, 60.0) + 100.0);
}

TEST(PausedViewer, DoesNotAffectOthers) {
    SimulatedLink wide;
    SimulatedLink paused = link_of(3.0);
    paused.viewer = "v2";
    paused.is_paused = [](double t) { return t > 20.0; };
    const StreamRecord record = simulate({}, {wide, paused}, 60.0);
    EXPECT_GT(num_steps(record, 0.0, 20.0), 0) << "it must count while it is present";
    EXPECT_EQ(record.sent.back().level, 0u);
    EXPECT_EQ(num_steps(record, 30.0, 60.0), 0);
    // and a viewer that never starts
    paused.is_paused = [](double) { return true; };
    EXPECT_EQ(simulate({}, {wide, paused}, 30.0).steps.size(), 0u);
}

TEST(VerySlowViewer, LowersTheStreamToTheMinimumOnly) {
    SimulatedLink wide;
    SimulatedLink slow = link_of(0.5);
    slow.viewer = "v2";
    const StreamRecord record = simulate(site_of(1, {.min_mbit_per_s = 4.0}), {wide, slow}, 60.0);
    EXPECT_GE(carried_bit_per_s(record.viewers[0], 5.0, 60.0), 0.7 * 4e6);
    EXPECT_LE(sent_bit_per_s(record, 5.0, 60.0), 1.3 * 4e6);
    EXPECT_LE(num_steps(record, 5.0, 60.0), 20);
}

TEST(ConfiguredCap, HoldsOverEverySecond) {
    for (const double cap : {3.0, 8.0, 25.0}) {
        SimulatedLink wide;
        const StreamRecord record = simulate(site_of(1, {.max_mbit_per_s = cap}), {wide}, 60.0);
        EXPECT_LE(busiest_second_bits(record), kMega * cap) << cap;
        EXPECT_GE(sent_bit_per_s(record, 5.0, 60.0), 0.7 * kMega * cap) << cap;
        // the size of the scene itself grows and shrinks twice by half
        EXPECT_LE(num_steps(record, 5.0, 60.0), 20) << cap;
    }
}

// Links that change at random every 30 s. Each has its own loss, jitter and scene.
class RandomLinks : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomLinks, NeitherOscillateNorGetStuck) {
    std::mt19937_64 random(GetParam());
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution(low, high)(random);
    };
    constexpr double kSeconds = 240.0;
    std::vector<double> mbit;  // per 30 s
    for (int i = 0; i < 9; ++i) mbit.push_back(std::exp(uniform(std::log(3.0), std::log(60.0))));
    SimulatedLink link;
    link.bit_per_s = [&](double t) { return kMega * mbit[static_cast<std::size_t>(t / 30.0)]; };
    link.delay_ms = uniform(5.0, 60.0);
    link.jitter_ms = std::min(uniform(0.0, 10.0), link.delay_ms);
    link.loss = uniform(0.0, 0.02);
    link.buffer_ms = uniform(100.0, 500.0);
    SimulatedSite site;
    site.seed = GetParam();
    site.fixed_bytes = uniform(6e3, 16e3);
    const StreamRecord record = simulate(site, {link}, kSeconds);
    for (double minute = 0.0; minute < kSeconds; minute += 60.0)
        EXPECT_LE(num_steps(record, minute, minute + 60.0), 30) << "from " << minute << " s";
    for (std::size_t part = 0; part < 8; ++part) {
        const double from_s = 30.0 * static_cast<double>(part);
        const double wanted = std::min(mbit[part] * kMega, 20e6);
        EXPECT_GE(carried_bit_per_s(record.viewers[0], from_s + 20.0, from_s + 30.0), 0.3 * wanted)
            << mbit[part] << " Mbit/s from " << from_s << " s";
        EXPECT_LT(median_age_ms(record.viewers[0], from_s + 3.0, from_s + 30.0),
                  way_ms(link, record, from_s + 3.0, from_s + 30.0) + 2.1 * link.delay_ms + 40.0)
            << mbit[part] << " Mbit/s from " << from_s << " s";
    }
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomLinks, testing::Range<std::uint64_t>(1, 21));

}  // namespace
}  // namespace atrium::test
