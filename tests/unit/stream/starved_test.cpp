// A lack of processor time is not a narrow network. Starved viewers and sites, over links with and
// without a limit.
#include "tests/support/network/simulated_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace atrium::test {
namespace {

constexpr double kMbit = 1e6;
constexpr std::uint64_t kNumSeeds = 10;

/// Takes processor time from a viewer.
struct Starvation {
    std::string name;
    void (*apply)(SimulatedLink& link, std::uint64_t seed);
};

std::ostream& operator<<(std::ostream& out, const Starvation& starvation) {
    return out << starvation.name;
}

const Starvation kQuota{"quota", [](SimulatedLink& link, std::uint64_t seed) {
                            link.receiver_runs = link.taker_runs = with_quota(0.3, seed);
                        }};
const Starvation kBusyLoops{"busy_loops", [](SimulatedLink& link, std::uint64_t seed) {
                                link.receiver_runs = beside_busy_loops(seed);
                                link.taker_runs = beside_busy_loops(seed + 1000);
                            }};
const Starvation kFreezes{"freezes", [](SimulatedLink& link, std::uint64_t seed) {
                              link.receiver_runs = link.taker_runs = with_freezes(seed);
                          }};
const Starvation kNone{"none", [](SimulatedLink&, std::uint64_t) {}};

class StarvedViewer : public testing::TestWithParam<Starvation> {
protected:
    SimulatedLink link_of(double mbit_per_s, std::uint64_t seed) const {
        SimulatedLink link;
        link.bit_per_s = [=](double t) { return t < 10.0 ? 1e9 : kMbit * mbit_per_s; };
        GetParam().apply(link, seed);
        return link;
    }
};

TEST_P(StarvedViewer, LowersNothingOnAnUnlimitedLink) {
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
        for (const double loss : {0.0, 0.01}) {
            SimulatedLink link = link_of(1000.0, seed);
            link.loss = loss;
            link.jitter_ms = 5.0;
            SimulatedSite site;
            site.seed = seed;
            const StreamRecord record = simulate(site, {link}, 300.0);
            EXPECT_EQ(record.steps.size(), 0U) << "seed " << seed << " loss " << loss;
            EXPECT_EQ(record.sent.size(), 9000U) << "seed " << seed << " loss " << loss;
        }
    }
}

// Time from which on the site never sends more than the link carries.
double found_s(const StreamRecord& record, double bit_per_s) {
    double found = 0.0;
    for (double t = 10.0; t < 40.0; t += 0.1) {
        if (sent_bit_per_s(record, t, t + 1.0) > 1.15 * bit_per_s) found = t + 0.1 - 10.0;
    }
    return found;
}

TEST_P(StarvedViewer, StillFindsARealLimit) {
    for (const double mbit : {5.0, 20.0}) {
        double latest = 0.0;
        double sum = 0.0;
        double used = 1.0;
        for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
            SimulatedLink link = link_of(mbit, seed);
            SimulatedSite site;
            site.seed = seed;
            const StreamRecord record = simulate(site, {link}, 60.0);
            const double found = found_s(record, kMbit * mbit);
            latest = std::max(latest, found);
            sum += found;
            used = std::min(used, sent_bit_per_s(record, 20.0, 60.0) / (kMbit * mbit));
        }
        std::printf("%s %g Mbit/s: found after %.2f s, at most %.1f s; used at least %.0f %%\n",
                    GetParam().name.c_str(),
                    mbit,
                    sum / kNumSeeds,
                    latest,
                    100.0 * used);
        EXPECT_LE(latest, 1.0) << mbit;
        EXPECT_GE(used, 0.65) << mbit;
    }
}

INSTANTIATE_TEST_SUITE_P(All,
                         StarvedViewer,
                         testing::Values(kNone, kQuota, kBusyLoops, kFreezes),
                         [](const auto& one) { return one.param.name; });

TEST(StarvedSite, LowersNothing) {
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
        SimulatedSite site;
        site.seed = seed;
        site.interrupted = 0.1;
        for (const Runs& runs :
             {with_quota(0.3, seed), beside_busy_loops(seed), with_freezes(seed)}) {
            site.runs = runs;
            const StreamRecord record = simulate(site, {SimulatedLink{}}, 120.0);
            EXPECT_EQ(record.steps.size(), 0U) << "seed " << seed;
        }
    }
}

}  // namespace
}  // namespace atrium::test
