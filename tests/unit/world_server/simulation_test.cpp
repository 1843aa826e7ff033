#include "world_server/simulation.hpp"

#include "simulation_stage.hpp"
#include "tests/support/world/physics_meshes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <thread>

namespace atrium::world_server {
namespace {

using Clock = std::chrono::steady_clock;

TEST(Simulation, SkipsAStallInsteadOfLagging) {
    WorldServerConfig config = floor_and_ball();
    config.seconds = 1.0;
    int num_stalls = 0;
    auto simulation = simulation_of(config, [&](const std::string&) {
        ++num_stalls;
        const Clock::time_point end = Clock::now() + std::chrono::milliseconds(300);
        while (Clock::now() < end) continue;  // as if the machine were busy with something else
    });
    bus::SceneCommand nonsense;
    nonsense.sender = "eve";
    nonsense.kind = bus::CommandKind::kPush;
    nonsense.target = 77;
    ASSERT_FALSE(simulation.commands().put(std::move(nonsense), Clock::now()));
    simulation.run({});
    bus::WorldStatus status;
    simulation.fill(status);
    EXPECT_EQ(num_stalls, 1);
    EXPECT_EQ(status.num_refused, 1U);
    EXPECT_GE(status.num_skipped_ticks, 30U)
        << "the stall takes 36 ticks, of which 4 are caught up";
    EXPECT_GE(status.num_steps + status.num_skipped_ticks, 118U);
    EXPECT_LE(status.num_steps, 92U);
    EXPECT_GT(status.step.p99_ms, 250.0) << "the step time must include the stall";
}

TEST(Simulation, CountsStepsOnWhenAWorldIsLoaded) {
    const WorldServerConfig config = floor_and_ball();
    auto simulation = simulation_of(config, [](const std::string&) {});
    const auto num_steps_after = [&](int num) {
        for (int i = 0; i < num; ++i) simulation.step(Timestamp::now());
        bus::WorldStatus status;
        simulation.fill(status);
        return status.num_steps;
    };
    EXPECT_EQ(num_steps_after(50), 50U);
    bus::SceneEdit load;
    load.sender = "host";
    load.kind = bus::EditKind::kLoadWorld;
    load.world_file = "evening";
    ASSERT_TRUE(simulation.commands().put_prepared(
        {load, nullptr, std::make_shared<const WorldServerConfig>(config)}));
    EXPECT_EQ(num_steps_after(1), 51U) << "the tick of the loaded world begins anew";
}

TEST(Simulation, SendsTheTickInWhichATouchBegins) {
    WorldServerConfig config = floor_and_ball();
    config.send_hz = 0.01;  // the next regular state is due in a hundred seconds
    auto simulation = simulation_of(config, [](const std::string&) {});
    physics::PersonShaper shaper(config.person);
    const auto hand_at = [&](double x_m, std::int64_t ns) {
        return shaper.shape(
            physics_test::make_box_mesh(
                {0.1, 0.2, 0.2}, {Eigen::Quaterniond::Identity(), {x_m, 0, 0.12}}, 10),
            {1'000'000'000 + ns});
    };
    hand_at(-0.17, 0);
    simulation.people().put("alice", hand_at(-0.13, 33'333'333));  // 3 cm into the ball
    std::jthread running([&](std::stop_token stop) { simulation.run(stop); });
    const Clock::time_point patience = Clock::now() + std::chrono::seconds(20);
    Outbox::Content content;
    while (!content.has_state && Clock::now() < patience)
        simulation.outbox().take(content, {}, patience);
    ASSERT_TRUE(content.has_state);
    const bus::ObjectState& ball = content.state.rigid.objects[1];
    EXPECT_GT(ball.linear_velocity.x(), 0.1);
    EXPECT_LT(ball.world_from_object.translation.x(), 0.03) << "the touch has only begun";
}

TEST(Simulation, StampsStatesWithTheirDueTime) {
    WorldServerConfig config = floor_and_ball();
    config.seconds = 0.5;
    auto simulation = simulation_of(config, [](const std::string&) {});
    std::vector<bus::SceneState> states;
    {
        std::jthread reader([&](std::stop_token stop) {
            Outbox::Content content;
            while (!stop.stop_requested()) {
                simulation.outbox().take(
                    content, stop, Clock::now() + std::chrono::milliseconds(50));
                if (content.has_state) states.push_back(content.state.rigid);
            }
        });
        simulation.run({});
    }
    ASSERT_GT(states.size(), 5U);
    bus::WorldStatus status;
    simulation.fill(status);
    // a busy machine makes it skip ticks: the time of a skipped tick passes, but it has no number
    std::int64_t num_skipped = 0;
    for (std::size_t i = 1; i < states.size(); ++i) {
        const double apart_s =
            1e-9 * static_cast<double>((states[i].time - states[i - 1].time).count());
        const std::int64_t periods = std::llround(apart_s * config.tick_hz);
        EXPECT_NEAR(apart_s, static_cast<double>(periods) / config.tick_hz, 5e-4)
            << "the stamp must not depend on the time of computation";
        const auto ticks = static_cast<std::int64_t>(states[i].tick - states[i - 1].tick);
        EXPECT_GE(periods, ticks);
        num_skipped += periods - ticks;
    }
    EXPECT_LE(num_skipped, static_cast<std::int64_t>(status.num_skipped_ticks));
}

}  // namespace
}  // namespace atrium::world_server
