// Cost of a person in the world server: one mesh (sample it, measure its motion) and one tick among
// objects. Single-threaded. The mesh is a closed figure of spheres and boxes.
#include "tests/support/world/physics_meshes.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/world.hpp"

#include <benchmark/benchmark.h>

#include <vector>

namespace atrium::physics {
namespace {

// A person who reaches out at 1.5 m/s while walking at 1 m/s, and back again.
std::vector<geometry::TriangleMesh> walking_figure(int num_cuts) {
    std::vector<geometry::TriangleMesh> meshes;
    for (int frame = 0; frame < 18; ++frame) {
        const int i = frame < 10 ? frame : 18 - frame;
        meshes.push_back(
            physics_test::make_person_mesh({i / 30.0, 0, 0}, 0.4 + 0.05 * i, num_cuts));
    }
    return meshes;
}

Timestamp frame_time(std::int64_t frame) { return {1'000'000'000 + frame * 33'333'333}; }

void shape_person(benchmark::State& state) {
    const auto meshes = walking_figure(static_cast<int>(state.range(0)));
    PersonShaper shaper({});
    std::int64_t frame = 0;
    std::size_t num_surfels = 0;
    for (auto _ : state) {
        const auto& mesh = meshes[static_cast<std::size_t>(frame) % meshes.size()];
        const PersonShape shape = shaper.shape(mesh, frame_time(frame));
        num_surfels = shape.surfels->size();
        benchmark::DoNotOptimize(num_surfels);
        ++frame;
    }
    state.counters["triangles"] = static_cast<double>(meshes[0].triangles.size());
    state.counters["surfels"] = static_cast<double>(num_surfels);
}
BENCHMARK(shape_person)->Arg(12)->Arg(24)->Arg(44)->Unit(benchmark::kMillisecond);

// The step thread's work on a new mesh: take it over, and sort it in the next tick.
void take_in_person(benchmark::State& state) {
    const auto meshes = walking_figure(24);
    PersonShaper shaper({});
    const PersonShape first = shaper.shape(meshes[0], frame_time(0));
    const PersonShape second = shaper.shape(meshes[1], frame_time(1));
    World world({});
    bool is_first = true;
    for (auto _ : state) {
        world.set_person("anna", is_first ? first : second);
        world.tick();
        is_first = !is_first;
    }
}
BENCHMARK(take_in_person)->Unit(benchmark::kMillisecond);

// Two people among `range(0)` balls and boxes on the floor, with a new mesh of each every 4 ticks.
void tick_world(benchmark::State& state) {
    World world({});
    world.add({.id = 1, .shape = ObjectShape::kPlane});
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(state.range(0)); ++i) {
        const bool is_ball = i % 2 == 0;
        world.add({.id = 2 + i,
                   .shape = is_ball ? ObjectShape::kSphere : ObjectShape::kBox,
                   .size_m = Eigen::Vector3d::Constant(0.2),
                   .mass_kg = 0.5,
                   .world_from_object = {Eigen::Quaterniond::Identity(),
                                         {0.3 * (i % 5), 0.3 * (i / 5) - 0.6, 1.0}}});
    }
    const auto meshes = walking_figure(24);
    PersonShaper shaper({});
    std::vector<PersonShape> shapes;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        shapes.push_back(shaper.shape(meshes[i], frame_time(static_cast<std::int64_t>(i))));
    }
    std::size_t tick = 0;
    for (auto _ : state) {
        if (tick % 4 == 0) {
            world.set_person("anna", shapes[tick / 4 % shapes.size()]);
            world.set_person("ben", shapes[(tick / 4 + 5) % shapes.size()]);
        }
        if (tick % 480 == 0) world.reset();  // keeps objects in the air and in the way
        world.tick();
        ++tick;
    }
    state.counters["surfels"] = static_cast<double>(world.num_surfels());
    state.counters["contact_ticks"] = static_cast<double>(world.counters().num_contact_ticks);
}
BENCHMARK(tick_world)->Arg(20)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace atrium::physics

BENCHMARK_MAIN();
