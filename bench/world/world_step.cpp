// CPU time of a world's steps, and of taking a person's mesh, on one thread. Writes comma-separated
// values, a row per setting, which world_step.sh keeps. The world has rigid bodies, a curtain, a
// soft ball (and more of both), and a puppet on strings. The people are figures of spheres and
// boxes who walk and reach among them, with meshes at 30 Hz.
#include "bench/thread_time.hpp"
#include "tests/support/world/physics_meshes.hpp"
#include "world_server/config.hpp"
#include "world_server/description/puppet.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/scene.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

constexpr int kTicksPerMesh = 4;  // 30 Hz
constexpr int kTicksPerState = 2;
constexpr int kNumPoses = 20;                                 // forth, and as many back
constexpr int kTicksPerWalk = 2 * kNumPoses * kTicksPerMesh;  // forth and back
constexpr int kTicksPerReset = 2 * kTicksPerWalk;             // 2.7 s
constexpr int kTicks = 10 * kTicksPerReset;                   // of the standard setting, 27 s,
constexpr int kTicksOfSweep = 4 * kTicksPerReset;             // and of the others
constexpr int kWarmUpTicks = 60;
constexpr double kApartM = 0.6;  // of people, along y

struct Setting {
    std::string sweep;
    int bodies = 100;
    int people = 2;
    int triangles = 10'000;
    int soft = 2;
    int puppets = 1;
};

[[noreturn]] void fail(const std::string& message, int code) {
    fmt::print(stderr, "{}\n", message);
    std::exit(code);
}

// Cuts of a figure's parts that give at most this many triangles.
int cuts_for(int triangles) {
    int cuts = 2;
    while (
        physics_test::make_person_mesh(Eigen::Vector3d::Zero(), 0.3, cuts + 1).triangles.size() <=
        static_cast<std::size_t>(triangles)) {
        ++cuts;
    }
    return cuts;
}

double place_of(int person) { return kApartM * (person - 1); }

// A person who walks at 1 m/s and reaches out at 0.5 m/s, to and fro. The second round is kept,
// whose first mesh has a predecessor.
std::vector<physics::PersonShape> walk(int person, int triangles, std::vector<double>& shape_ms) {
    physics::PersonShaper shaper(physics::PersonShapeOptions{});
    std::vector<physics::PersonShape> shapes(2 * kNumPoses);
    const int cuts = cuts_for(triangles);
    for (int i = 0; i < 4 * kNumPoses; ++i) {
        const int pose = i % (2 * kNumPoses);
        const int there = pose < kNumPoses ? pose : 2 * kNumPoses - pose;
        const Eigen::Vector3d feet(-0.7 + there / 30.0, place_of(person), 0.0);
        const auto mesh = physics_test::make_person_mesh(feet, 0.3 + there / 60.0, cuts);
        const double begin_ms = thread_ms();
        shapes[static_cast<std::size_t>(pose)] =
            shaper.shape(mesh, {1'000'000'000 + i * 33'333'333LL});
        shape_ms.push_back(thread_ms() - begin_ms);
    }
    return shapes;
}

void add_floor(world_server::WorldServerConfig& config) {
    world_server::WorldObject floor;
    floor.rigid.id = 1;
    floor.name = "floor";
    floor.rigid.shape = physics::ObjectShape::kPlane;
    floor.rigid.size_m = {8.0, 8.0, 0.001};
    config.objects.push_back(floor);
}

// Balls and boxes in turn, in layers above the people's paths.
void add_bodies(world_server::WorldServerConfig& config, int num) {
    for (int i = 0; i < num; ++i) {
        world_server::WorldObject body;
        body.rigid.id = static_cast<std::uint32_t>(config.objects.size() + 1);
        body.name = fmt::format("body-{}", i);
        body.rigid.shape = i % 2 == 0 ? physics::ObjectShape::kSphere : physics::ObjectShape::kBox;
        body.rigid.size_m = Eigen::Vector3d::Constant(0.2);
        body.rigid.mass_kg = 0.5;
        body.rigid.world_from_object.translation = {
            0.3 * (i % 5) - 0.6, 0.3 * (i / 5 % 5) - 0.9, 0.8 + 0.3 * (i / 25)};
        config.objects.push_back(body);
    }
}

// Puppets on strings, each in front of one person.
void add_puppets(world_server::WorldServerConfig& config, int num) {
    for (int i = 0; i < num; ++i) {
        world_server::PuppetDescription description;
        description.name = fmt::format("puppet-{}", i);
        description.world_from_puppet.translation = {0.35, place_of(1 + i) + 0.17, 1.0};
        description.string_m = 0.45;
        const auto puppet = world_server::make_puppet(
            description, static_cast<std::uint32_t>(config.objects.size() + 1));
        config.objects.insert(config.objects.end(), puppet.parts.begin(), puppet.parts.end());
        config.joints.insert(config.joints.end(), puppet.joints.begin(), puppet.joints.end());
    }
}

// In turn a curtain, in front of the hands, and a ball, in front of the feet: those of
// curtain.toml.
void add_soft(world_server::WorldServerConfig& config, int num) {
    for (int i = 0; i < num; ++i) {
        world_server::WorldSoftObject soft;
        soft.name = fmt::format("soft-{}", i);
        physics::SoftObject& object = soft.object;
        object.id = static_cast<std::uint32_t>(config.objects.size() + config.soft.size() + 1);
        if (i % 2 == 0) {
            object.shape = physics::SoftShape::kCloth;
            object.size_m = {0.8, 1.9, 0.01};
            object.spacing_m = 0.08;
            object.stiffness = 0.3;
            object.damping_hz = 1.5;
            object.pins = {{.place = physics::PinPlace::kTop}};
            object.world_from_object.translation = {0.3, place_of(i / 2), 1.15};
            object.world_from_object.rotation =
                Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ());
        } else {
            object.shape = physics::SoftShape::kBall;
            object.size_m = Eigen::Vector3d::Constant(0.34);
            object.spacing_m = 0.045;
            object.stiffness = 0.6;
            object.world_from_object.translation = {-0.3, place_of(1 - i / 2), 0.18};
        }
        object.mass_kg = 0.5;
        config.soft.push_back(soft);
    }
}

world_server::Scene make_scene(const Setting& setting) {
    world_server::WorldServerConfig config;
    config.max_objects = 1000;
    add_floor(config);
    add_bodies(config, setting.bodies);
    add_puppets(config, setting.puppets);
    add_soft(config, setting.soft);
    auto scene = world_server::Scene::create(config);
    if (!scene) fail(scene.error().message, 1);
    return std::move(*scene);
}

struct Times {
    std::vector<double> step_ms;   // all work of the simulating thread in a tick
    std::vector<double> take_ms;   // taking a mesh, a part of it
    std::vector<double> shape_ms;  // preparing it, on another thread
    std::size_t num_contact_ticks = 0;
    std::size_t num_soft_contact_ticks = 0;
    std::size_t num_moving = 0;  // rigid objects, over all ticks
    std::uint64_t hash = 0;      // of the final state: proves that the same work was done
};

Times measure(const Setting& setting) {
    Times times;
    const int num_ticks = setting.sweep == "standard" ? kTicks : kTicksOfSweep;
    world_server::Scene scene = make_scene(setting);
    physics::World& world = scene.world();
    std::vector<std::vector<physics::PersonShape>> people;
    for (int p = 0; p < setting.people; ++p)
        people.push_back(walk(p, setting.triangles, times.shape_ms));
    bus::SceneState state;
    std::vector<bus::SoftBodyState> soft_states;
    std::vector<physics::RigidState> rigid;
    physics::WorldCounters before;
    for (int tick = 0; tick < kWarmUpTicks + num_ticks; ++tick) {
        if (tick == kWarmUpTicks) before = world.counters();
        // back into the air and in the way, while people have stepped back
        if (tick % kTicksPerReset == 0) world.reset();
        double take_ms = 0.0;
        for (int p = 0; p < setting.people; ++p) {
            // not all in the same tick, because sites have independent clocks
            if (tick % kTicksPerMesh != p % kTicksPerMesh) continue;
            const auto& shapes = people[static_cast<std::size_t>(p)];
            const auto at = static_cast<std::size_t>(tick / kTicksPerMesh) % shapes.size();
            const std::string name = fmt::format("person{}", p);
            const double begin_ms = thread_ms();
            world.set_person(name, shapes[at]);
            const double ms = thread_ms() - begin_ms;
            if (tick >= kWarmUpTicks) times.take_ms.push_back(ms);
            take_ms += ms;
        }
        const double begin_ms = thread_ms();
        world.tick();
        if (tick % kTicksPerState == 0) {
            scene.get_state("world", {tick}, state);
            scene.get_soft_states({tick}, soft_states);
        }
        if (tick < kWarmUpTicks) continue;
        times.step_ms.push_back(take_ms + (thread_ms() - begin_ms));
        world.get_states(rigid);
        times.num_moving += static_cast<std::size_t>(
            std::count_if(rigid.begin(), rigid.end(), [](const physics::RigidState& s) {
                return s.linear_velocity.norm() > 0.02;
            }));
    }
    const physics::WorldCounters& after = world.counters();
    times.hash = world.state_hash();
    times.num_contact_ticks = after.num_contact_ticks - before.num_contact_ticks;
    times.num_soft_contact_ticks = after.num_soft_contact_ticks - before.num_soft_contact_ticks;
    return times;
}

void print(const Setting& setting, const Times& times) {
    const auto share = [&](std::size_t num) {
        return static_cast<double>(num) / static_cast<double>(times.step_ms.size());
    };
    fmt::print(
        "{},{},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.4f},{:.4f},{:.3f},{:.3f},{:.3f},{:.1f},{:016x}"
        "\n",
        setting.sweep,
        setting.bodies,
        setting.people,
        setting.triangles,
        setting.soft,
        setting.puppets,
        quantile(times.step_ms, 0.5),
        quantile(times.step_ms, 0.99),
        quantile(times.step_ms, 1.0),
        quantile(times.take_ms, 0.5),
        quantile(times.take_ms, 1.0),
        quantile(times.shape_ms, 0.5),
        share(times.num_contact_ticks),
        share(times.num_soft_contact_ticks),
        share(times.num_moving),
        times.hash);
    std::fflush(stdout);
}

// world_step [SWEEP]: all settings, or those of one sweep
int run(const std::vector<std::string>& arguments) {
    std::vector<Setting> settings{{.sweep = "standard"}};
    for (const int bodies : {10, 25, 50, 100, 200, 400})
        settings.push_back({.sweep = "bodies", .bodies = bodies});
    for (const int people : {0, 1, 2, 3, 4})
        settings.push_back({.sweep = "people", .people = people});
    for (const int triangles : {2'000, 5'000, 10'000, 20'000, 40'000})
        settings.push_back({.sweep = "triangles", .triangles = triangles});
    for (const int soft : {0, 2, 4}) settings.push_back({.sweep = "soft", .soft = soft});
    fmt::print(
        "sweep,bodies,people,triangles,soft,puppets,median_ms,p99_ms,max_ms,take_median_ms,"
        "take_max_ms,shape_ms,touched,soft_touched,moving,state_hash\n");
    if (!arguments.empty())
        std::erase_if(settings, [&](const Setting& s) { return s.sweep != arguments[0]; });
    const double begin_ms = thread_ms();
    for (std::size_t i = 0; i < settings.size(); ++i) {
        print(settings[i], measure(settings[i]));
        // the table usually goes to a file: show progress to the user, who waits for minutes
        fmt::print(stderr,
                   "{} of {} settings, {:.0f} s of processor time: {}\n",
                   i + 1,
                   settings.size(),
                   (thread_ms() - begin_ms) / 1e3,
                   settings[i].sweep);
    }
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run({argv + 1, argv + argc}); }
