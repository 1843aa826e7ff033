// A separate executable, because it replaces operator new.
#include "simulation_stage.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/support/world/physics_meshes.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace atrium::world_server {
namespace {

using Clock = std::chrono::steady_clock;

void add_soft_ball(WorldServerConfig& config) {
    WorldSoftObject soft;
    soft.name = "soft-ball";
    soft.object.id = 3;
    soft.object.shape = physics::SoftShape::kBall;
    soft.object.size_m.setConstant(0.3);
    soft.object.world_from_object.translation = {0.0, 0.5, 0.4};
    config.soft = {soft};
}

TEST(Simulation, StepsAndSendsStatesWithoutAllocation) {
    WorldServerConfig config = floor_and_ball();
    add_soft_ball(config);
    auto simulation = simulation_of(config, [](const std::string&) {});
    // a person who stands in the soft object, with the rigid one at the feet
    physics::PersonShaper shaper{physics::PersonShapeOptions{}};
    simulation.people().put(
        "alice",
        shaper.shape(physics_test::make_person_mesh({0.1, 0.45, 0.0}, 0.3, 8), Timestamp{1}));
    simulation.want_people(true);
    Outbox::Content content;
    int num_people = 0;
    int num_states = 0, num_soft_states = 0;
    std::uint64_t newest = 0;
    const auto step = [&](int tick) {
        simulation.step(Timestamp{tick * 8'333'333LL});
        if (tick % 3 != 0) return;  // slower than states are made: some are replaced unread
        simulation.outbox().take(content, {}, Clock::now());
        if (content.has_people) {
            ++num_people;
            ASSERT_EQ(content.people.size(), 1U);
            EXPECT_GT(content.people.front().surfels->size(), 500U);
        }
        if (!content.has_state) return;
        ++num_states;
        num_soft_states += static_cast<int>(content.state.soft.size());
        EXPECT_GT(content.state.rigid.tick, newest) << "an older state followed a newer one";
        newest = content.state.rigid.tick;
        ASSERT_EQ(content.state.rigid.objects.size(), 2U);
        ASSERT_GT(content.state.soft.front().nodes.size(), 20U);
        EXPECT_EQ(content.state.soft.front().tick, newest);
    };
    for (int tick = 0; tick < 240; ++tick) step(tick);
    bus::WorldStatus warm;
    simulation.fill(warm);
    ASSERT_GT(warm.num_contacts, 0U) << "people must touch something";
    num_states = num_soft_states = num_people = 0;
    const std::uint64_t before = test::num_allocations();
    for (int tick = 240; tick < 600; ++tick) step(tick);
    EXPECT_EQ(test::num_allocations() - before, 0U);
    EXPECT_EQ(num_states, 120);
    EXPECT_EQ(num_soft_states, 120);
    EXPECT_EQ(num_people, 30) << "ten proxies a second";
}

}  // namespace
}  // namespace atrium::world_server
