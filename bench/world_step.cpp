// How long the steps of a world take, and taking in a person's mesh: comma-separated values, a row
// per setting; world_step.sh keeps them. One thread; the people are figures of spheres and boxes
// who walk and reach among falling things.
#include "tests/unit/physics/meshes.hpp"
#include "world_server/config.hpp"
#include "world_server/physics/person_shape.hpp"
#include "world_server/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kTicksPerMesh = 4;  // 30 Hz
constexpr int kNumPoses = 20;
constexpr int kTicks = 1200;
constexpr int kWarmUpTicks = 60;
constexpr std::uint32_t kFirstId = 5000;  // of what is added to the world file's things

struct Setting {
    std::string sweep;
    int bodies = 100;
    int people = 2;
    int triangles = 10'000;
};

double ms_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

world_server::WorldServerConfig load(const std::string& file) {
    world_server::WorldServerConfig config;
    auto reader = config::TableReader::load(file);
    if (reader) {
        config::OptionSet set;
        declare(config, set);
        set.read_file(*reader);
        read_world(*reader, config);
        if (const auto read = reader->finish(); read) return config;
        fmt::print(stderr, "{}: {}\n", file, reader->finish().error().message);
    } else {
        fmt::print(stderr, "{}\n", reader.error().message);
    }
    std::exit(2);
}

geometry::TriangleMesh figure(const Eigen::Vector3d& feet, double reach_m, int triangles) {
    int cuts = 2;
    while (physics_test::make_person_mesh(feet, reach_m, cuts + 1).triangles.size() <=
           static_cast<std::size_t>(triangles)) {
        ++cuts;
    }
    return physics_test::make_person_mesh(feet, reach_m, cuts);
}

// Somebody who walks at 1 m/s and reaches out at 1 m/s, to and fro.
std::vector<physics::PersonShape> walk(const Eigen::Vector3d& feet,
                                       int triangles,
                                       const physics::PersonShapeOptions& options,
                                       std::vector<double>& shape_ms) {
    physics::PersonShaper shaper(options);
    std::vector<physics::PersonShape> shapes;
    for (int i = 0; i < 2 * kNumPoses; ++i) {
        const int there = i < kNumPoses ? i : 2 * kNumPoses - i;
        const Eigen::Vector3d step(there / 30.0, 0.0, 0.0);
        const auto mesh = figure(feet + step, 0.3 + there / 60.0, triangles);
        const auto begin = Clock::now();
        shapes.push_back(shaper.shape(mesh, {1'000'000'000 + i * 33'333'333LL}));
        shape_ms.push_back(ms_since(begin));
    }
    return shapes;
}

void add_bodies(physics::World& world, int num) {
    for (int i = 0; i < num; ++i) {
        const bool is_ball = i % 2 == 0;
        physics::RigidObject body;
        body.id = kFirstId + static_cast<std::uint32_t>(i);
        body.shape = is_ball ? physics::ObjectShape::kSphere : physics::ObjectShape::kBox;
        body.size_m = Eigen::Vector3d::Constant(0.2);
        body.mass_kg = 0.5;
        body.world_from_object.translation = {
            0.3 * (i % 5) - 0.6, 0.3 * (i / 5 % 5) - 0.6, 0.8 + 0.3 * (i / 25)};
        if (world.add(body) != physics::AddResult::kAdded) {
            fmt::print(stderr, "the world has no room for {} bodies more\n", num);
            std::exit(1);
        }
    }
}

void measure(const std::string& file, const Setting& setting) {
    auto config = load(file);
    config.max_objects = std::max(config.max_objects, 1000);
    auto scene = world_server::Scene::create(config);
    if (!scene) {
        fmt::print(stderr, "{}\n", scene.error().message);
        std::exit(1);
    }
    physics::World& world = scene->world();
    add_bodies(world, setting.bodies);
    std::vector<double> shape_ms;
    std::vector<std::vector<physics::PersonShape>> people;
    for (int p = 0; p < setting.people; ++p) {
        const Eigen::Vector3d feet(-0.7 + 0.1 * p, -0.6 + 0.4 * p, 0.0);
        people.push_back(walk(feet, setting.triangles, config.person, shape_ms));
    }
    std::vector<double> step_ms;
    std::vector<double> take_ms;
    for (int tick = 0; tick < kTicks; ++tick) {
        if (tick % 240 == 0) world.reset();  // keeps things in the air and in the way
        for (int p = 0; p < setting.people; ++p) {
            // not both in the same tick, as sites have clocks of their own
            if (tick % kTicksPerMesh != p % kTicksPerMesh) continue;
            const auto& shapes = people[static_cast<std::size_t>(p)];
            const auto& shape =
                shapes[static_cast<std::size_t>(tick / kTicksPerMesh) % shapes.size()];
            const auto begin = Clock::now();
            world.set_person(fmt::format("person{}", p), shape);
            if (tick >= kWarmUpTicks) take_ms.push_back(ms_since(begin));
        }
        const auto begin = Clock::now();
        world.tick();
        if (tick >= kWarmUpTicks) step_ms.push_back(ms_since(begin));
    }
    fmt::print("{},{},{},{},{:.3f},{:.3f},{:.3f},{:.4f},{:.4f},{:.3f}\n",
               setting.sweep,
               setting.bodies,
               setting.people,
               setting.triangles,
               quantile(step_ms, 0.5),
               quantile(step_ms, 0.99),
               quantile(step_ms, 1.0),
               quantile(take_ms, 0.5),
               quantile(take_ms, 1.0),
               quantile(shape_ms, 0.5));
    std::fflush(stdout);
}

// world_step [WORLD [NAME]]: the things of a world file, with bodies and people added; NAME: only
// this sweep
int run(const std::vector<std::string>& arguments) {
    const std::string file =
        !arguments.empty() ? arguments[0] : ATRIUM_SOURCE_DIR "/deploy/worlds/demo.toml";
    std::vector<Setting> settings{{.sweep = "standard"}};
    for (const int bodies : {10, 25, 50, 100, 200, 400})
        settings.push_back({.sweep = "bodies", .bodies = bodies});
    for (const int people : {0, 1, 2, 3, 4})
        settings.push_back({.sweep = "people", .people = people});
    for (const int triangles : {2'000, 5'000, 10'000, 20'000, 40'000})
        settings.push_back({.sweep = "triangles", .triangles = triangles});
    fmt::print(
        "sweep,bodies,people,triangles,median_ms,p99_ms,max_ms,take_median_ms,take_max_ms,"
        "shape_ms\n");
    for (const Setting& setting : settings) {
        if (arguments.size() > 1 && arguments[1] != setting.sweep) continue;
        measure(file, setting);
    }
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run({argv + 1, argv + argc}); }
