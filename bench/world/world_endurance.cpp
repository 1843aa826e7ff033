// Two people move about among the objects of every world of deploy/worlds for minutes. Checks all
// bounds of tests/support/world/endurance.hpp after every step. Writes comma-separated values, a
// row per world. Exits with 1 if a bound was broken. world_endurance.sh keeps the values. Once a
// minute all objects are reset, which keeps them in the way. Usage: world_endurance [MINUTES [WORLD
// ...]]
#include "bench/usage.hpp"
#include "core/base/thread_pool.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/config/rig.hpp"
#include "tests/support/shapes/decode_mesh.hpp"
#include "tests/support/world/endurance.hpp"
#include "tests/support/world/hull_film.hpp"
#include "world_server/config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace atrium::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kRateHz = 30.0;
constexpr double kPutBackS = 60.0;

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

// A person on the rosette, seen by the cameras of a room.
class Wanderer {
public:
    Wanderer(const test::HullFilm& film, double start_s, double phase_rad)
        : film_(film), start_s_(start_s), phase_rad_(phase_rad) {}

    physics::PersonShape shape(std::int64_t picture) {
        const double time_s = static_cast<double>(picture) / kRateHz;
        const auto frame = static_cast<std::size_t>(picture + std::lround(start_s_ * kRateHz)) %
                           film_.frames.size();
        auto mesh = value_of(test::decode_mesh(film_.frames[frame].draco));
        const geometry::RigidTransform world_from_feet = test::wander_place(time_s, phase_rad_);
        for (Eigen::Vector3d& vertex : mesh.vertices) vertex = world_from_feet * vertex;
        return shaper_.shape(mesh, {1'000'000'000 + std::llround(1e9 * time_s)});
    }

private:
    const test::HullFilm& film_;
    double start_s_;
    double phase_rad_;
    physics::PersonShaper shaper_{physics::PersonShapeOptions{}};
};

class Run {
public:
    Run(const fs::path& file, const test::EnduranceBounds& bounds)
        : name_(file.stem().string()),
          config_(load(file)),
          scene_(value_of(world_server::Scene::create(config_))),
          watch_(scene_, config_.joints, bounds) {}

    // Runs up to a time, with new people.
    void advance(const std::vector<physics::PersonShape>& people, double until_s) {
        for (std::size_t p = 0; p < people.size(); ++p)
            scene_.world().set_person(fmt::format("person{}", p), people[p]);
        const double tick_s = 1.0 / config_.tick_hz;
        const auto ticks_per_reset = static_cast<std::int64_t>(kPutBackS / tick_s);
        for (; static_cast<double>(tick_) * tick_s < until_s - 1e-9; ++tick_) {
            if (tick_ > 0 && tick_ % ticks_per_reset == 0) {
                scene_.world().reset();
                watch_.forget();
            }
            const auto begin = std::chrono::steady_clock::now();
            scene_.world().tick();
            seconds_ +=
                std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
            watch_.look(static_cast<double>(tick_) * tick_s);
        }
    }

    bool print(double minutes) const {
        const test::EnduranceFigures& f = watch_.figures();
        const physics::WorldCounters& counters = scene_.world().counters();
        std::string left = "";
        for (const physics::Incident& incident : f.incidents) {
            left += fmt::format("{}{} {}",
                                left.empty() ? "" : "; ",
                                incident.object,
                                physics::describe(incident.kind));
        }
        const auto ticks = static_cast<double>(counters.num_ticks);
        fmt::print(
            "{},{:.1f},{},{:.3f},{:.2f},{:.1f},{:.2f},{:.3f},{:.3f},{:.1f},{:.1f},{:.3f},"
            "{},{:.5f},{},{},{},{},{},{:.3f},\"{}\",\"{}\"\n",
            name_,
            minutes,
            scene_.num_objects(),
            static_cast<double>(counters.num_contact_ticks) / ticks,
            f.rigid_mps,
            f.spin_rad_s,
            f.soft_mps,
            f.rigid_specific,
            f.soft_specific,
            f.energy_j,
            f.energy_bound_j,
            f.lowest_m,
            f.num_untouched,
            f.untouched_gain_j,
            counters.num_not_finite,
            counters.num_runaways,
            counters.num_torn,
            counters.num_strays,
            counters.num_escapes,
            1e3 * seconds_ / ticks,
            f.broken,
            left);
        return f.broken.empty();
    }

    const std::string& name() const { return name_; }
    const std::string& broken() const { return watch_.figures().broken; }

private:
    std::string name_;
    world_server::WorldServerConfig config_;
    world_server::Scene scene_;
    test::WorldWatch watch_;
    std::int64_t tick_ = 0;
    double seconds_ = 0.0;  // spent in ticks
};

std::vector<fs::path> worlds_of(const std::vector<std::string>& arguments) {
    std::vector<fs::path> worlds;
    for (std::size_t i = 1; i < arguments.size(); ++i) worlds.emplace_back(arguments[i]);
    if (!worlds.empty()) return worlds;
    for (const auto& entry : fs::directory_iterator(ATRIUM_SOURCE_DIR "/deploy/worlds"))
        if (entry.path().extension() == ".toml") worlds.push_back(entry.path());
    std::sort(worlds.begin(), worlds.end());
    return worlds;
}

int run(const std::vector<std::string>& arguments) {
    const fs::path root = ATRIUM_SOURCE_DIR;
    const double minutes = arguments.empty() ? 10.0 : std::strtod(arguments[0].c_str(), nullptr);
    if (!(minutes > 0.0 && minutes <= 600.0)) {
        fmt::print(stderr, "MINUTES is a number of up to 600, not {}\n", arguments[0]);
        return 2;
    }
    test::FilmOptions options;
    options.cameras = value_of(config::load_rig(root / "deploy/rigs/full_body.toml")).cameras;
    options.rate_hz = kRateHz;
    const test::Act act = test::wander_act("ada");
    const auto film = value_of(test::film(act, options, root / ".cache/world_trials"));
    const test::EnduranceBounds bounds{.people_mps = test::wander_speed_mps(act)};
    fmt::print(stderr,
               "people move at up to {:.2f} m/s, {} pictures\n",
               bounds.people_mps,
               film.frames.size());

    std::vector<std::unique_ptr<Run>> runs;
    for (const fs::path& world : worlds_of(arguments))
        runs.push_back(std::make_unique<Run>(world, bounds));
    std::vector<Wanderer> people{{film, 0.0, 0.0}, {film, test::kWanderLoopS / 2.0, 2.0}};
    ThreadPool pool(std::max(1U, std::thread::hardware_concurrency()));
    const auto num_pictures = static_cast<std::int64_t>(std::llround(60.0 * minutes * kRateHz));
    std::vector<physics::PersonShape> shapes(people.size());
    std::int64_t at = 0;
    const auto shape = [&](std::size_t p, std::size_t) { shapes[p] = people[p].shape(at); };
    for (std::int64_t picture = 0; picture < num_pictures; ++picture) {
        at = picture;
        pool.parallel_for(people.size(), shape);
        const auto advance = [&](std::size_t i, std::size_t) {
            runs[i]->advance(shapes, static_cast<double>(picture + 1) / kRateHz);
        };
        pool.parallel_for(runs.size(), advance);
        if ((picture + 1) % static_cast<std::int64_t>(15 * kRateHz) != 0) continue;
        fmt::print(stderr, "{:.2f} min", static_cast<double>(picture + 1) / kRateHz / 60.0);
        for (const auto& r : runs)
            if (!r->broken().empty()) fmt::print(stderr, "; {}: {}", r->name(), r->broken());
        fmt::print(stderr, "\n");
    }
    fmt::print("# people at up to {:.2f} m/s\n", bounds.people_mps);
    fmt::print(
        "world,minutes,objects,touched,rigid_mps,spin_rad_s,soft_mps,rigid_specific,"
        "soft_specific,energy_j,energy_bound_j,lowest_m,untouched_ticks,untouched_gain_j,"
        "not_finite,runaways,torn,left,led_out,tick_ms,broken,incidents\n");
    bool all_fine = true;
    for (const auto& r : runs) all_fine = r->print(minutes) && all_fine;
    return all_fine ? 0 : 1;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) {
    return atrium::bench::run(
        atrium::bench::words_or_usage(argc,
                                      argv,
                                      {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10},
                                      "usage: world_endurance [MINUTES [WORLD.toml ...]]    10 "
                                      "minutes of all delivered worlds by default\n"));
}
