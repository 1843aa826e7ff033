// Two people who move about in every world of deploy/worlds, minute after minute: whether anything
// explodes. Speeds and energy are looked at after every step; comma-separated values, a row per
// world, and exit code 1 where a bound was broken. Usage: world_endurance [MINUTES [WORLD ...]]
#include "core/codec/mesh_codec.hpp"
#include "core/config/rig.hpp"
#include "simulation/choreography.hpp"
#include "tests/support/hull_film.hpp"
#include "world_server/config.hpp"
#include "world_server/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 30.0;
constexpr double kLoopS = 3.0;
constexpr double kResetS = 30.0;  // things are put back, so that there is something to push
// Nobody moves faster than 3 m/s here. What is hit leaves with at most 2.2 times that; what falls
// 2 m has 6.3 m/s.
constexpr double kMostMps = 11.0;
constexpr double kGravity = 9.81;

template <typename T>
T value_of(Expected<T> result) {
    if (result) return std::move(*result);
    fmt::print(stderr, "{}\n", result.error().message);
    std::exit(2);
}

world_server::WorldServerConfig load(const fs::path& file) {
    world_server::WorldServerConfig config;
    auto reader = value_of(config::TableReader::load(file));
    config::OptionSet set;
    declare(config, set);
    set.read_file(reader);
    read_world(reader, config);
    if (const auto read = reader.finish(); !read) {
        fmt::print(stderr, "{}\n", read.error().message);
        std::exit(2);
    }
    return config;
}

// One of the built-in motions, on the spot.
test::Act loop_of(simulation::Motion motion, const std::string& name, const std::string& look) {
    test::Act act;
    act.name = "loop-" + name + "-" + look;
    act.look = look;
    act.seconds = kLoopS - 0.5 / kRateHz;
    act.pose = [motion](double t) { return simulation::posture(motion, t / kLoopS); };
    act.site_from_feet = [](double) { return geometry::RigidTransform{}; };
    return act;
}

// Somebody who walks a rosette of 1.5 m around the world's middle, half a metre a second, and does
// one motion after the other.
class Wanderer {
public:
    Wanderer(std::vector<test::HullFilm> loops,
             double phase,
             const physics::PersonShapeOptions& options)
        : loops_(std::move(loops)), phase_(phase), shaper_(options) {}

    physics::PersonShape shape(double time_s, Timestamp stamp) {
        const auto turn = static_cast<std::size_t>(time_s / kLoopS);
        const test::HullFilm& loop = loops_[(turn + (phase_ > 0.0 ? 1 : 0)) % loops_.size()];
        const auto frame =
            static_cast<std::size_t>(std::lround(time_s * kRateHz)) % loop.frames.size();
        auto mesh = value_of(codec::decode_mesh(loop.frames[frame].draco));
        const Eigen::Vector2d place = place_at(time_s);
        const Eigen::Vector2d way = place_at(time_s + 0.01) - place;
        const geometry::RigidTransform world_from_person{
            Eigen::Quaterniond(Eigen::AngleAxisd(
                std::atan2(way.y(), way.x()) - std::numbers::pi / 2, Eigen::Vector3d::UnitZ())),
            {place.x(), place.y(), 0.0}};
        for (Eigen::Vector3d& vertex : mesh.vertices) vertex = world_from_person * vertex;
        return shaper_.shape(mesh, stamp);
    }

private:
    Eigen::Vector2d place_at(double t) const {
        const double a = 0.23 * t + phase_;
        return 1.5 * std::cos(1.618 * a) * Eigen::Vector2d(std::cos(a), std::sin(a));
    }

    std::vector<test::HullFilm> loops_;
    double phase_;
    physics::PersonShaper shaper_;
};

struct Extremes {
    double speed_mps = 0.0;
    double spin_rad_s = 0.0;
    double energy_j = 0.0;
    double energy_bound_j = 0.0;
    std::string broken;  // the first bound that was, and when
};

void look(const std::vector<physics::RigidState>& states,
          const std::vector<bus::SceneObject>& objects,
          double time_s,
          Extremes& extremes) {
    double energy_j = 0.0;
    double mass_kg = 0.0;
    for (std::size_t i = 0; i < states.size(); ++i) {
        const double m = objects[i].mass_kg;
        if (m <= 0.0) continue;
        const double speed = states[i].linear_velocity.norm();
        const double height = states[i].world_from_object.translation.z();
        extremes.speed_mps = std::max(extremes.speed_mps, speed);
        extremes.spin_rad_s = std::max(extremes.spin_rad_s, states[i].angular_velocity.norm());
        energy_j += m * (0.5 * speed * speed + kGravity * std::max(0.0, height));
        mass_kg += m;
        const bool is_fine = std::isfinite(speed) && std::isfinite(height) && speed <= kMostMps;
        if (!is_fine && extremes.broken.empty())
            extremes.broken =
                fmt::format("{} at {:.2f} m/s after {:.2f} s", objects[i].name, speed, time_s);
    }
    extremes.energy_j = std::max(extremes.energy_j, energy_j);
    // everything two metres up and at a walk, which never happens
    extremes.energy_bound_j = mass_kg * (kGravity * 2.0 + 0.5 * 3.0 * 3.0);
    if (energy_j > extremes.energy_bound_j && extremes.broken.empty())
        extremes.broken = fmt::format("energy {:.0f} J after {:.2f} s", energy_j, time_s);
}

bool endure(const fs::path& file, double seconds, const std::vector<test::HullFilm>& loops) {
    const auto config = load(file);
    auto scene = value_of(world_server::Scene::create(config));
    physics::World& world = scene.world();
    std::vector<Wanderer> people;
    people.emplace_back(loops, 0.0, config.person);
    people.emplace_back(loops, 2.0, config.person);
    const double tick_s = 1.0 / config.tick_hz;
    std::vector<physics::RigidState> states;
    const auto objects = scene.objects();
    Extremes extremes;
    std::int64_t num_meshes = 0;
    const auto num_ticks = static_cast<std::int64_t>(seconds / tick_s);
    for (std::int64_t tick = 0; tick < num_ticks; ++tick) {
        const double time_s = static_cast<double>(tick) * tick_s;
        if (time_s * kRateHz >= static_cast<double>(num_meshes)) {
            const Timestamp stamp{1'000'000'000 + num_meshes * 33'333'333};
            for (std::size_t p = 0; p < people.size(); ++p)
                world.set_person(fmt::format("person{}", p),
                                 people[p].shape(static_cast<double>(num_meshes) / kRateHz, stamp));
            ++num_meshes;
        }
        const auto ticks_per_reset = static_cast<std::int64_t>(kResetS / tick_s);
        if (tick % ticks_per_reset == 0) world.reset();
        world.tick();
        world.get_states(states);
        if (states.size() == objects.size()) look(states, objects, time_s, extremes);
    }
    const auto& counters = world.counters();
    fmt::print("{},{:.1f},{},{:.2f},{:.1f},{:.0f},{:.0f},{},{},{},{},\"{}\"\n",
               file.stem().string(),
               seconds / 60.0,
               objects.size(),
               extremes.speed_mps,
               extremes.spin_rad_s,
               extremes.energy_j,
               extremes.energy_bound_j,
               counters.num_contact_ticks,
               counters.num_escapes,
               counters.num_strays,
               counters.num_not_finite,
               extremes.broken);
    std::fflush(stdout);
    return extremes.broken.empty() && counters.num_not_finite == 0;
}

int run(const std::vector<std::string>& arguments) {
    const fs::path root = ATRIUM_SOURCE_DIR;
    test::FilmOptions options;
    options.cameras = value_of(config::load_rig(root / "deploy/rigs/full_body.toml")).cameras;
    options.rate_hz = kRateHz;
    std::vector<test::HullFilm> loops;
    for (const std::string name : {"walk", "push", "wave", "sway", "raise"}) {
        const auto act = loop_of(*simulation::find_motion(name), name, "ada");
        loops.push_back(value_of(test::film(act, options, root / ".cache/world_trials")));
    }
    std::vector<fs::path> worlds;
    for (std::size_t i = 1; i < arguments.size(); ++i) worlds.emplace_back(arguments[i]);
    if (worlds.empty()) {
        for (const auto& entry : fs::directory_iterator(root / "deploy/worlds"))
            if (entry.path().extension() == ".toml") worlds.push_back(entry.path());
        std::sort(worlds.begin(), worlds.end());
    }
    const double minutes = arguments.empty() ? 10.0 : std::stod(arguments[0]);
    fmt::print(
        "world,minutes,objects,speed_mps,spin_rad_s,energy_j,energy_bound_j,contact_ticks,"
        "escapes,strays,not_finite,broken\n");
    bool all_fine = true;
    for (const fs::path& world : worlds)
        all_fine =
            endure(world, 60.0 * minutes / static_cast<double>(worlds.size()), loops) && all_fine;
    return all_fine ? 0 : 1;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run({argv + 1, argv + argc}); }
