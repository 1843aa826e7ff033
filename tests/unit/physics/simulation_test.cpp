#include "world_server/simulation.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace atrium::world_server {
namespace {

using Clock = std::chrono::steady_clock;

WorldServerConfig floor_and_ball() {
    WorldServerConfig config;
    WorldObject floor;
    floor.scene.object = 1;
    floor.scene.name = "floor";
    floor.scene.shape = bus::Shape::kPlane;
    WorldObject ball;
    ball.scene.object = 2;
    ball.scene.name = "ball";
    ball.scene.shape = bus::Shape::kSphere;
    ball.scene.size_m.setConstant(0.2);
    ball.scene.mass_kg = 0.5;
    ball.scene.world_from_object.translation = {0, 0, 0.1};
    config.objects = {floor, ball};
    config.tick_hz = 120.0;
    return config;
}

Simulation simulation_of(const WorldServerConfig& config,
                         std::function<void(const std::string&)> reject) {
    return {config, Scene::create(config).value(), std::move(reject)};
}

TEST(Simulation, SkipsAStallInsteadOfRunningBehindIt) {
    WorldServerConfig config = floor_and_ball();
    config.seconds = 1.0;
    int num_stalls = 0;
    auto simulation = simulation_of(config, [&](const std::string&) {
        ++num_stalls;
        const Clock::time_point end = Clock::now() + std::chrono::milliseconds(300);
        while (Clock::now() < end) continue;  // as when the machine does something else
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
    EXPECT_GE(status.num_skipped_ticks, 30U) << "of the 36 that the stall took, 4 are made up";
    EXPECT_GE(status.num_steps + status.num_skipped_ticks, 118U);
    EXPECT_LE(status.num_steps, 92U);
    EXPECT_GT(status.step.p99_ms, 250.0) << "and it shows";
}

TEST(Simulation, StampsStatesWithTheTimeTheyWereDue) {
    WorldServerConfig config = floor_and_ball();
    config.seconds = 0.5;
    auto simulation = simulation_of(config, [](const std::string&) {});
    std::vector<bus::SceneState> states;
    {
        std::jthread reader([&](std::stop_token stop) {
            while (!stop.stop_requested()) {
                auto content =
                    simulation.outbox().take(stop, Clock::now() + std::chrono::milliseconds(50));
                if (content.state) states.push_back(std::move(*content.state));
            }
        });
        simulation.run({});
    }
    ASSERT_GT(states.size(), 5U);
    bus::WorldStatus status;
    simulation.fill(status);
    if (status.num_skipped_ticks > 0) GTEST_SKIP() << "the machine was too busy for real time";
    for (std::size_t i = 1; i < states.size(); ++i) {
        const double ticks = static_cast<double>(states[i].tick - states[i - 1].tick);
        const double apart_s = static_cast<double>((states[i].time - states[i - 1].time).count());
        EXPECT_NEAR(apart_s * 1e-9, ticks / 120.0, 5e-4) << "whenever it was computed";
    }
}

}  // namespace
}  // namespace atrium::world_server
