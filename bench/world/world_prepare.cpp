// CPU time to prepare people's meshes for the physics, from coded bytes to moving surfels, on one
// thread. Writes comma-separated values, a row per act. The meshes are hulls from the cameras of a
// simulated room. The work is the same in every run, and its instructions can be counted (valgrind
// --tool=callgrind).
#include "bench/thread_time.hpp"
#include "bench/value_of.hpp"
#include "bench/world/trial_acts.hpp"
#include "bench/world/trial_options.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/config/rig.hpp"
#include "tests/support/shapes/decode_mesh.hpp"
#include "tests/support/world/hull_film.hpp"
#include "world_server/physics/people/person_shape.hpp"

#include <fmt/format.h>

#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

void measure(const std::string& name, const test::HullFilm& film, std::size_t max_meshes) {
    physics::PersonShaper shaper(physics::PersonShapeOptions{});
    std::vector<double> decode_ms;
    std::vector<double> shape_ms;
    std::vector<double> all_ms;
    std::vector<double> triangles;
    std::vector<double> surfels;
    std::uint64_t hash = 0;  // proves that the same work was done
    for (const auto& frame : film.frames) {
        if (frame.draco.empty()) continue;
        if (all_ms.size() == max_meshes) break;
        const double begin = thread_ms();
        const auto mesh = value_of(test::decode_mesh(frame.draco));
        const double decoded = thread_ms();
        const auto shape =
            shaper.shape(mesh, Timestamp{static_cast<std::int64_t>(1e9 * (1.0 + frame.capture_s))});
        const double end = thread_ms();
        decode_ms.push_back(decoded - begin);
        shape_ms.push_back(end - decoded);
        all_ms.push_back(end - begin);
        triangles.push_back(static_cast<double>(mesh.triangles.size()));
        surfels.push_back(static_cast<double>(shape.surfels->size()));
        for (const physics::MovingSurfel& surfel : *shape.surfels) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, surfel.velocity.data(), sizeof bits);
            hash = 31 * hash + bits;
        }
    }
    fmt::print("{},{},{:.0f},{:.0f},{:.3f},{:.3f},{:.3f},{:.3f},{:016x}\n",
               name,
               all_ms.size(),
               quantile(triangles, 0.5),
               quantile(surfels, 0.5),
               quantile(decode_ms, 0.5),
               quantile(shape_ms, 0.5),
               quantile(all_ms, 0.5),
               quantile(all_ms, 0.99),
               hash);
    std::fflush(stdout);
}

// world_prepare [--rig FILE] [--trials MESHES] [--only ACTS]
int run(int argc, char** argv) {
    TrialOptions options;
    options.num_trials = 60;
    const app::Start started =
        start({"world_prepare",
               "Measures what it costs to prepare a person's mesh for the physics. `--trials` is "
               "the number of meshes of each act. Hulls are kept in .cache/world_trials.",
               "  world_prepare --trials 30 --only clasp\n"},
              options,
              argc,
              argv);
    if (!started.go_on) return started.exit_code;
    test::FilmOptions filming;
    filming.cameras = value_of(config::load_rig(options.rig)).cameras;
    fmt::print("act,meshes,triangles,surfels,decode_ms,shape_ms,median_ms,p99_ms,velocity_hash\n");
    for (const std::string name : {"clasp", "throw", "tray"}) {
        if (!options.wants(name)) continue;
        const test::Act act = trial_acts().at(name)(options.first);
        filming.seed = options.first + 1;
        filming.first_s = 0.001 * static_cast<double>(options.first * 7 % 33);
        measure(name,
                value_of(test::film(act, filming, ATRIUM_SOURCE_DIR "/.cache/world_trials")),
                options.num_trials);
    }
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
