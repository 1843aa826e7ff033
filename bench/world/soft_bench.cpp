// Cost of soft objects: one tick of the curtain, the soft ball and both, alone and with a person
// who walks through. Single-threaded.
#include "tests/support/world/physics_meshes.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/soft/soft_object.hpp"
#include "world_server/physics/world.hpp"

#include <benchmark/benchmark.h>

#include <numbers>
#include <vector>

namespace atrium::physics {
namespace {

enum Things : int { kCurtain = 1, kBall = 2 };

// As in deploy/worlds/curtain.toml.
void add_things(World& world, int things) {
    world.add({.id = 1, .shape = ObjectShape::kPlane});
    for (std::uint32_t i = 0; i < 2 && (things & kCurtain) != 0; ++i) {
        SoftObject cloth;
        cloth.id = 10 + i;
        cloth.size_m = {0.8, 1.9, 0.01};
        cloth.spacing_m = 0.08;
        cloth.mass_kg = 0.5;
        cloth.stiffness = 0.3;
        cloth.damping_hz = 1.5;
        cloth.pins = {{PinPlace::kTop}};
        cloth.world_from_object = {
            Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ())),
            {0.0, i == 0 ? 0.41 : -0.41, 1.15}};
        world.add_soft(cloth);
    }
    if ((things & kBall) == 0) return;
    SoftObject ball;
    ball.id = 20;
    ball.shape = SoftShape::kBall;
    ball.size_m.setConstant(0.34);
    ball.spacing_m = 0.045;
    ball.mass_kg = 0.5;
    ball.stiffness = 0.6;
    ball.world_from_object.translation = {0.0, -0.1, 0.18};
    world.add_soft(ball);
}

// range(0): Things; range(1): whether a person walks to and fro, with a new mesh every 4 ticks.
void tick_soft(benchmark::State& state) {
    World world({});
    add_things(world, static_cast<int>(state.range(0)));
    std::vector<PersonShape> shapes;
    PersonShaper shaper({});
    for (std::int64_t i = 0; i < 60; ++i) {
        const double x = i < 30 ? -0.75 + i / 20.0 : 0.75 - (i - 30) / 20.0;
        shapes.push_back(shaper.shape(physics_test::make_person_mesh({x, 0, 0}, 0.3, 20),
                                      {1'000'000'000 + i * 33'333'333}));
    }
    std::size_t tick = 0;
    for (auto _ : state) {
        if (state.range(1) != 0 && tick % 4 == 0) {
            world.set_person("anna", shapes[tick / 4 % shapes.size()]);
        }
        world.tick();
        ++tick;
    }
    std::vector<SoftState> states;
    world.get_soft_states(states);
    std::size_t num_nodes = 0;
    for (const SoftState& s : states) num_nodes += s.positions.size();
    state.counters["nodes"] = static_cast<double>(num_nodes);
    state.counters["touched_share"] = static_cast<double>(world.counters().num_contact_ticks) /
                                      static_cast<double>(world.counters().num_ticks);
}
BENCHMARK(tick_soft)
    ->ArgsProduct({{0, kCurtain, kBall, kCurtain | kBall}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace atrium::physics

BENCHMARK_MAIN();
