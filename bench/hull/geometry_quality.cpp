// Compares the shape of simulated people, as a site computes it, with their true surface. Writes
// rows of comma-separated values, one per instant. geometry_quality.sh keeps them and makes the
// table of docs/measurements/hull.md.
#include "bench/hull/filmed_instant.hpp"
#include "bench/value_of.hpp"
#include "core/app/program.hpp"
#include "core/config/rig.hpp"
#include "simulation/look.hpp"
#include "simulation/person.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/hull/corner_rounding.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/refine/photo_refinement.hpp"
#include "tests/support/shapes/solid_error.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

struct Options {
    std::filesystem::path rig = ATRIUM_SOURCE_DIR "/deploy/rigs/full_body_1mp.toml";
    std::string look;  // empty: all
    int instants = 5;  // of each motion
};

struct Row {
    std::string look;
    std::string motion;
    double time_s = 0.0;
    std::string shape;
    std::size_t num_triangles = 0;
    double work_ms = 0.0;  // to make it
    test::SolidError error;
};

double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

void print(const Row& row) {
    const test::SolidError& e = row.error;
    fmt::print(
        "{},{},{:.2f},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.2f},{:.2f},{:.2f},{:.2f}\n",
        row.look,
        row.motion,
        row.time_s,
        row.shape,
        row.num_triangles,
        row.work_ms,
        e.true_volume_l,
        e.volume_l,
        e.excess_l,
        e.missing_l,
        e.mean_mm,
        e.p95_mm,
        e.true_mean_mm,
        e.true_p95_mm);
    std::fflush(stdout);
}

void measure(const std::string& look, const std::string& motion, const Options& options) {
    simulation::RoomOptions room_options;
    room_options.look = look;
    room_options.motion = motion;
    const auto rig = value_of(config::load_rig(options.rig));
    auto room = value_of(simulation::RoomRenderer::create(rig.cameras, room_options));
    hull::HullScratch scratch;
    hull::CornerRounding rounding;
    refine::PhotoRefinement photo;
    for (int i = 0; i < options.instants; ++i) {
        const double time_s = room_options.loop_s * (i + 0.5) / options.instants;
        const FilmedInstant instant = film(room, time_s);
        const auto start = std::chrono::steady_clock::now();
        const geometry::TriangleMesh hull =
            hull_of(instant, scratch, fmt::format("{} {} at {:.2f} s", look, motion, time_s));
        const double hull_ms = ms_since(start);
        const geometry::TriangleMesh truth = room.person().mesh(time_s);
        print({look,
               motion,
               time_s,
               "hull",
               hull.triangles.size(),
               hull_ms,
               test::compare_solids(truth, hull)});
        geometry::TriangleMesh rounded = hull;
        const auto rounding_start = std::chrono::steady_clock::now();
        rounding.round(rounded, instant.silhouette_pointers());
        const double rounded_ms = hull_ms + ms_since(rounding_start);
        print({look,
               motion,
               time_s,
               "rounded",
               rounded.triangles.size(),
               rounded_ms,
               test::compare_solids(truth, rounded)});
        const auto refine = [&](const char* shape, geometry::TriangleMesh mesh, double before_ms) {
            SerialExecutor executor;
            const auto refining_start = std::chrono::steady_clock::now();
            photo.forget();  // the instant before is another pose
            photo.refine(mesh, instant.picture_views(room.cameras()), executor);
            const double ms = before_ms + ms_since(refining_start);
            print({look,
                   motion,
                   time_s,
                   shape,
                   mesh.triangles.size(),
                   ms,
                   test::compare_solids(truth, mesh)});
        };
        refine("photo", hull, hull_ms);
        refine("round_photo", rounded, rounded_ms);
    }
}

int run(int argc, char** argv) {
    Options options;
    config::OptionSet set;
    set.add("rig", options.rig, "cameras of the simulated room, a rig file");
    set.add("look", options.look, "only this person; empty: all");
    set.add("instants", options.instants, "of each motion", {1, 100});
    const app::Start started =
        app::start({"geometry_quality",
                    "Compares the hulls of simulated people with their true surface: volume "
                    "outside of the body, volume that is missing, distances.",
                    "  geometry_quality --look ada --instants 1\n"},
                   set,
                   argc,
                   argv);
    if (!started.go_on) return started.exit_code;
    fmt::print(
        "look,motion,time_s,shape,triangles,work_ms,true_l,volume_l,excess_l,missing_l,mean_mm,p95_"
        "mm,"
        "true_mean_mm,true_p95_mm\n");
    for (const std::string& look : simulation::look_names()) {
        if (!options.look.empty() && look != options.look) continue;
        for (const char* motion : kMotions) measure(look, motion, options);
    }
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
