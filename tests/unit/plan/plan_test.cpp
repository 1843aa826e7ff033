#include "tests/unit/plan/a_plan.hpp"
#include "tools/plan/render_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::plan {
namespace {

using testing::an_input;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

double stage(const HostPlan& host, const std::string& name) {
    for (const Stage& each : host.stages) {
        if (each.name == name) return each.work_ms;
    }
    return -1.0;
}

TEST(Plan, AddsUpTheWorkOfEachHost) {
    const SitePlan plan = make_plan(an_input(16, 4, 10.0));
    ASSERT_EQ(plan.hosts.size(), 5u);
    const HostPlan& node = plan.hosts[0];
    EXPECT_DOUBLE_EQ(stage(node, "silhouettes"), 4 * 2.0);
    EXPECT_DOUBLE_EQ(stage(node, "textures"), 4 * 1.0);
    EXPECT_DOUBLE_EQ(stage(node, "messages"), 4 * 0.1);
    EXPECT_DOUBLE_EQ(stage(node, "hull"), -1.0);
    EXPECT_NEAR(node.load, 12.4e-3 * 10.0 / 4, 1e-12);
    const HostPlan& model = plan.hosts[4];
    EXPECT_NEAR(stage(model, "hull"), 16 * 0.5e-3 * 4800, 1e-9);
    EXPECT_NEAR(stage(model, "mesh"), 0.1 * 4 * 4.8, 1e-9);
    // textures to the viewer, silhouettes to the model part
    EXPECT_NEAR(node.out_mbit_per_s, 8e-6 * 10 * (4 * 10000 + 4 * (16 * 300 + 330)), 1e-9);
    EXPECT_NEAR(model.in_mbit_per_s, 8e-6 * 10 * 16 * (16 * 300 + 330), 1e-9);
    // four silhouettes on three threads, one core less than there are; the way, the hull, the mesh
    EXPECT_NEAR(plan.latency_ms, 2 * 2.0 + 0.3 + 38.4 / 3 + 1.92, 1e-9);
    EXPECT_THAT(plan.problems, IsEmpty());
}

// Sixteen cameras; two regions of eight cameras each, one of them on a host of its own.
PlanInput input_with_regions(double rate_hz) {
    PlanInput input = an_input(16, 4, rate_hz);
    hosts::HostEntry help;
    help.name = "help";
    help.regions = {"south"};
    input.hosts.push_back(help);
    input.regions = {{"north", {}, ""}, {"south", {}, "help"}};
    for (std::size_t i = 0; i < 16; ++i)
        input.regions[i / 8].cameras.push_back("cam" + std::to_string(i));
    return input;
}

TEST(Plan, RegionsDivideTheWorkOfTheHull) {
    PlanInput input = input_with_regions(10.0);
    const SitePlan plan = make_plan(input);
    ASSERT_EQ(plan.hosts.size(), 6u);
    const HostPlan& model = plan.hosts[4];
    const HostPlan& help = plan.hosts[5];
    // half of the views and segments
    EXPECT_NEAR(stage(model, "hull"), 8 * 0.5e-3 * 2400, 1e-9);
    EXPECT_NEAR(stage(help, "hull"), 8 * 0.5e-3 * 2400, 1e-9);
    EXPECT_THAT(model.regions, ::testing::ElementsAre("north"));
    EXPECT_THAT(help.regions, ::testing::ElementsAre("south"));
    EXPECT_THAT(help.programs, ::testing::ElementsAre("site_node --config FILE --host help"));
    // the silhouettes of eight cameras there, the mesh back
    const double order_bytes = 8 * (16 * 300 + 330);
    const double mesh_bytes = 4 * 2400 * 1.5;
    EXPECT_NEAR(help.in_mbit_per_s, 8e-6 * 10 * order_bytes, 1e-9);
    EXPECT_NEAR(help.out_mbit_per_s, 8e-6 * 10 * mesh_bytes, 1e-9);
    EXPECT_NEAR(model.out_mbit_per_s, 8e-6 * 10 * (order_bytes + 2 * 2 * mesh_bytes), 1e-9);
    // kilobytes cost, too: half of it on each side
    input.costs.message_ms.slope = 0.01;
    const SitePlan dearer = make_plan(input);
    EXPECT_NEAR(stage(dearer.hosts[5], "messages") - stage(help, "messages"),
                0.5e-5 * (order_bytes + mesh_bytes),
                1e-9);
    // the way there and back, at 1 Gbit/s
    const double ways_ms = 2 * 0.3 + 8e-6 * (order_bytes + mesh_bytes);
    EXPECT_NEAR(plan.latency_ms, 2 * 2.0 + 0.3 + ways_ms + 9.6 / 3 + 0.96, 1e-9);
    EXPECT_THAT(plan_text(plan, {}), HasSubstr("hulls    1 region: south"));
    EXPECT_THAT(plan_text(plan, {}), HasSubstr("one person in each region"));
}

// A camera that watches two regions sees the people of both.
TEST(Plan, ACameraOfTwoRegionsHasTwiceTheTextures) {
    PlanInput input = input_with_regions(10.0);
    const SitePlan before = make_plan(input);
    input.regions[0].cameras.push_back("cam8");  // on node0
    const SitePlan after = make_plan(input);
    EXPECT_NEAR(stage(after.hosts[0], "textures"), stage(before.hosts[0], "textures") + 1.0, 1e-9);
    // its silhouettes are those of both people, in both hulls
    EXPECT_NEAR(stage(after.hosts[4], "hull"), 9 * 0.5e-3 * (8 * 300 + 600), 1e-9);
    EXPECT_NEAR(stage(after.hosts[5], "hull"), 8 * 0.5e-3 * (7 * 300 + 600), 1e-9);
    EXPECT_NEAR(stage(after.hosts[5], "mesh"), stage(before.hosts[5], "mesh"), 1e-9);
}

TEST(Plan, OneProcessHasNoMessages) {
    const SitePlan plan = make_plan(an_input(8, 0, 10.0));
    ASSERT_EQ(plan.hosts.size(), 1u);
    EXPECT_DOUBLE_EQ(stage(plan.hosts[0], "messages"), -1.0);
    EXPECT_DOUBLE_EQ(plan.hosts[0].in_mbit_per_s, 0.0);
    EXPECT_THAT(plan.hosts[0].programs, ::testing::ElementsAre("site_node --config FILE"));
}

TEST(Plan, AFasterHostHasLessWork) {
    PlanInput input = an_input(8, 2, 10.0);
    input.hosts[0].score = 200.0;
    input.hosts[0].cores = 8;
    const SitePlan plan = make_plan(input);
    EXPECT_DOUBLE_EQ(plan.hosts[0].speed, 2.0);
    EXPECT_NEAR(plan.hosts[0].load, plan.hosts[1].load / 4.0, 1e-12);
}

TEST(Plan, NamesWhatDoesNotFitAndTheCure) {
    const auto problems = [](PlanInput input) {
        std::string text;
        for (const std::string& problem : make_plan(std::move(input)).problems)
            text += problem + "\n";
        return text;
    };
    EXPECT_EQ(problems(an_input(16, 4, 30.0)), "");
    // 64 views: 0.5 us * 64 * 19200 = 614 ms
    EXPECT_THAT(problems(an_input(64, 16, 30.0)),
                HasSubstr("host hull: hull of a metaframe lasts 205 ms with 3 threads, the period "
                          "is 33.3 ms: 5 metaframes/s at most. Use [[hull.region]]"));
    PlanInput weak = an_input(8, 1, 60.0);
    weak.hosts[0].cores = 1;
    EXPECT_THAT(problems(weak), HasSubstr("host node0: its work takes 149 % of its 1 cores"));
    PlanInput slow = an_input(8, 1, 60.0);
    slow.are_live = true;
    EXPECT_THAT(problems(slow),
                HasSubstr("host node0: 3840 Mbit/s from its cameras, its link carries 1000"));
    PlanInput many = an_input(8, 1, 60.0);
    many.num_viewers = 50;
    EXPECT_THAT(problems(many), HasSubstr("Mbit/s out of it"));
}

TEST(Plan, ShowsAllInTextAndJson) {
    const SitePlan plan = make_plan(an_input(4, 1, 30.0));
    const std::string text = plan_text(plan, SimulationResult{29.9, 0.01, 12.5, 20.25, {0.5}});
    for (const char* part : {"site hall: 4 cameras at 30/s on 2 hosts",
                             "node0  (4 cores, 3 threads)",
                             "runs     camera_node --config FILE --host node0",
                             "4 cameras: cam0 cam1 cam2 cam3",
                             "no cameras",
                             "simulated 29.9 metaframes/s, 1.0 % dropped, 12.5 ms",
                             "it fits",
                             "assumed:"})
        EXPECT_THAT(text, HasSubstr(part));
    const std::string json = plan_json(plan, {});
    EXPECT_THAT(json, HasSubstr("\"fits\": true"));
    EXPECT_THAT(json, HasSubstr("\"simulation\": null"));
}

}  // namespace
}  // namespace atrium::plan
