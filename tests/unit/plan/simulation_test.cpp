#include "tools/plan/simulation.hpp"

#include "tests/unit/plan/a_plan.hpp"

#include <gtest/gtest.h>

namespace atrium::plan {
namespace {

using testing::an_input;

TEST(PlanSimulation, WithTimeToSpareNothingWaits) {
    const SitePlan plan = make_plan(an_input(16, 4, 10.0));
    const SimulationResult result = simulate(plan, {.spread = 0.0});
    EXPECT_NEAR(result.metaframes_per_s, 10.0, 0.1);
    EXPECT_DOUBLE_EQ(result.dropped, 0.0);
    // messages take part of the node's time here
    EXPECT_NEAR(result.median_ms, plan.latency_ms, 0.5);
    EXPECT_NEAR(result.p99_ms, result.median_ms, 1e-6);
    ASSERT_EQ(result.loads.size(), plan.hosts.size());
    EXPECT_NEAR(result.loads[0], plan.hosts[0].load, 0.01);
    ASSERT_TRUE(plan.hosts.back().cameras.empty());
    EXPECT_NEAR(result.loads.back(), plan.hosts.back().load, 0.003) << "with its messages";
}

TEST(PlanSimulation, RegionsOnTwoHostsAreComputedAtTheSameTime) {
    PlanInput input = an_input(16, 4, 10.0);
    hosts::HostEntry& help = input.hosts.emplace_back();
    help.name = "help";
    help.regions = {"south"};
    input.regions = {{"north", {}, ""}, {"south", {}, "help"}};
    for (std::size_t i = 0; i < 16; ++i)
        input.regions[i / 8].cameras.push_back("cam" + std::to_string(i));
    const SitePlan plan = make_plan(input);
    const SimulationResult result = simulate(plan, {.spread = 0.0});
    EXPECT_NEAR(result.metaframes_per_s, 10.0, 0.1);
    EXPECT_NEAR(result.median_ms, plan.latency_ms, 0.6);
    for (std::size_t i = 0; i < plan.hosts.size(); ++i)
        EXPECT_NEAR(result.loads[i], plan.hosts[i].load, 0.003) << plan.hosts[i].name;
    // on one host they come after each other
    input.regions[1].host.clear();
    EXPECT_GT(simulate(make_plan(input), {.spread = 0.0}).median_ms, result.median_ms + 2.0);
}

TEST(PlanSimulation, TooMuchWorkDropsMetaframesAndKeepsTheAge) {
    // the hull takes 38.4 ms on one core
    PlanInput input = an_input(16, 4, 60.0);
    input.hosts.back().cores = 1;
    const SitePlan plan = make_plan(input);
    const SimulationResult result = simulate(plan, {.spread = 0.0});
    const Stage& messages = plan.hosts.back().stages.back();
    ASSERT_EQ(messages.name, "messages");
    // the messages of all instants come first
    const double left = 1.0 - 1e-3 * 60.0 * messages.work_ms;
    EXPECT_NEAR(result.metaframes_per_s, left * 1e3 / (38.4 + 1.92), 0.5);
    EXPECT_NEAR(result.dropped, 1.0 - result.metaframes_per_s / 60.0, 0.02);
    // it waits for at most one other metaframe
    EXPECT_LT(result.p99_ms, 2.0 * (38.4 + 1.92) + 10.0);
}

TEST(PlanSimulation, AProgramUsesItsThreadsOnly) {
    PlanInput input = an_input(16, 4, 10.0);
    input.num_threads = 1;
    const SimulationResult result = simulate(make_plan(input), {.spread = 0.0});
    // four silhouettes after each other, then the whole hull
    EXPECT_NEAR(result.median_ms, 4 * 2.1 + 0.3 + 38.4 + 1.92, 0.5);
}

TEST(PlanSimulation, SharedCoresAreShared) {
    const SitePlan plan = make_plan(an_input(16, 4, 10.0));
    const SimulationResult own = simulate(plan, {});
    const SimulationResult shared = simulate(plan, {.shared_cores = 2});
    EXPECT_GT(shared.median_ms, own.median_ms);
    ASSERT_EQ(shared.loads.size(), 1u);
    double work_ms = 0.0;
    for (const HostPlan& host : plan.hosts) work_ms += host.load * host.cores;
    EXPECT_NEAR(shared.loads[0], work_ms / 2, 0.05);
}

class PlanSimulationOfAny : public ::testing::TestWithParam<int> {};

TEST_P(PlanSimulationOfAny, NeverDoesMoreThanItsCoresCan) {
    const auto seed = static_cast<std::uint64_t>(GetParam());
    const SitePlan plan = make_plan(
        an_input(2 + seed % 30, 1 + seed % 5, 5.0 + 7.0 * static_cast<double>(seed % 17)));
    const SimulationResult result =
        simulate(plan, {.seconds = 5.0, .shared_cores = static_cast<int>(seed % 4), .seed = seed});
    for (const double load : result.loads) {
        EXPECT_GE(load, 0.0);
        EXPECT_LE(load, 1.0 + 1e-9);
    }
    EXPECT_GE(result.dropped, -1e-9);
    EXPECT_LE(result.metaframes_per_s, plan.input.rate_hz * 1.05);
    EXPECT_LE(result.median_ms, result.p99_ms);
}
INSTANTIATE_TEST_SUITE_P(Seeds, PlanSimulationOfAny, ::testing::Range(0, 60));

}  // namespace
}  // namespace atrium::plan
