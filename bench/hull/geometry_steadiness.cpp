// Measures how much the shape of simulated people flickers: places on the true surface, followed
// while the person moves, see the distance to the shape change from one metaframe to the next.
// geometry_steadiness.sh keeps the rows and makes the table of docs/measurements/hull.md.
#include "bench/hull/filmed_instant.hpp"
#include "bench/value_of.hpp"
#include "core/app/program.hpp"
#include "core/config/rig.hpp"
#include "core/geometry/surface_tree.hpp"
#include "simulation/look.hpp"
#include "simulation/person.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/hull/corner_rounding.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/refine/photo_refinement.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

constexpr int kNumPlaces = 2000;
constexpr double kMillimetres = 1e3;

struct Options {
    std::filesystem::path rig = ATRIUM_SOURCE_DIR "/deploy/rigs/full_body_1mp.toml";
    std::string look;     // empty: all
    int metaframes = 12;  // in a row, of each motion
};

// A place on the skin, which has the same triangles at all instants.
struct Place {
    std::size_t triangle = 0;
    Eigen::Vector3d shares;  // of its corners
};

std::vector<Place> places_on(const geometry::TriangleMesh& skin) {
    std::vector<double> areas;
    for (const auto& [a, b, c] : skin.triangles) {
        const Eigen::Vector3d along = skin.vertices[b] - skin.vertices[a];
        areas.push_back(along.cross(skin.vertices[c] - skin.vertices[a]).norm());
    }
    std::mt19937_64 random(1);
    std::discrete_distribution<std::size_t> triangle(areas.begin(), areas.end());
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::vector<Place> places(kNumPlaces);
    for (Place& place : places) {
        const double r = std::sqrt(share(random));
        const double s = share(random);
        place = {triangle(random), {1.0 - r, r * (1.0 - s), r * s}};
    }
    return places;
}

// Distances of the places from `shape` [mm], positive inside of it.
std::vector<double> depths_mm(const geometry::TriangleMesh& skin,
                              const std::vector<Place>& places,
                              const geometry::TriangleMesh& shape) {
    const geometry::SurfaceTree tree(shape);
    std::vector<double> depths;
    for (const Place& place : places) {
        Eigen::Vector3d at = Eigen::Vector3d::Zero();
        for (int k = 0; k < 3; ++k)
            at += place.shares[k] * skin.vertices[skin.triangles[place.triangle][k]];
        const double sign = tree.winding_number(at) > 0.5 ? 1.0 : -1.0;
        depths.push_back(kMillimetres * sign * tree.distance_m(at));
    }
    return depths;
}

// Of one shape over the metaframes of a motion.
struct Steadiness {
    std::vector<double> before_mm;
    std::vector<double> changes_mm;
    double out_mm = 0.0;  // mean distance of places that lie inside the shape, and outside of it
    double in_mm = 0.0;
    int num = 0;

    void add(std::vector<double> depths_mm) {
        for (const double depth : depths_mm) {
            (depth > 0.0 ? out_mm : in_mm) +=
                std::abs(depth) / static_cast<double>(depths_mm.size());
        }
        ++num;
        for (std::size_t i = 0; i < before_mm.size(); ++i)
            changes_mm.push_back(std::abs(depths_mm[i] - before_mm[i]));
        before_mm = std::move(depths_mm);
    }
    double mean_mm() const {
        double sum = 0.0;
        for (const double change : changes_mm) sum += change;
        return sum / static_cast<double>(changes_mm.size());
    }
    double share_mm(double share) const {
        std::vector<double> sorted = changes_mm;
        std::ranges::sort(sorted);
        return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
    }
};

void measure(const std::string& look, const std::string& motion, const Options& options) {
    simulation::RoomOptions room_options;
    room_options.look = look;
    room_options.motion = motion;
    const auto rig = value_of(config::load_rig(options.rig));
    auto room = value_of(simulation::RoomRenderer::create(rig.cameras, room_options));
    hull::HullScratch scratch;
    hull::CornerRounding rounding;
    refine::PhotoRefinement photo;
    refine::PhotoRefinement round_photo;
    refine::PhotoRefinement forgetful;
    SerialExecutor executor;
    const std::vector<Place> places = places_on(room.person().mesh(0.0));
    std::map<std::string, Steadiness> shapes;
    for (int i = 0; i < options.metaframes; ++i) {
        const double time_s = room_options.frame_time_s(i);
        const FilmedInstant instant = film(room, time_s);
        const geometry::TriangleMesh skin = room.person().mesh(time_s);
        const auto add = [&](const char* shape, const geometry::TriangleMesh& mesh) {
            shapes[shape].add(depths_mm(skin, places, mesh));
        };
        const geometry::TriangleMesh hull = hull_of(instant, scratch, look + " " + motion);
        add("hull", hull);
        geometry::TriangleMesh rounded = hull;
        rounding.round(rounded, instant.silhouette_pointers());
        add("rounded", rounded);
        const std::vector<refine::PictureView> views = instant.picture_views(room.cameras());
        geometry::TriangleMesh mesh = hull;
        forgetful.forget();
        forgetful.refine(mesh, views, executor);
        add("photo alone", mesh);
        mesh = hull;
        photo.refine(mesh, views, executor);
        add("photo", mesh);
        round_photo.refine(rounded, views, executor);
        add("round_photo", rounded);
    }
    for (const char* shape : {"hull", "rounded", "photo alone", "photo", "round_photo"}) {
        const Steadiness& of = shapes[shape];
        fmt::print("{},{},{},{:.3f},{:.3f},{:.3f},{:.3f}\n",
                   look,
                   motion,
                   shape,
                   of.mean_mm(),
                   of.share_mm(0.95),
                   of.out_mm / of.num,
                   of.in_mm / of.num);
        std::fflush(stdout);
    }
}

int run(int argc, char** argv) {
    Options options;
    config::OptionSet set;
    set.add("rig", options.rig, "cameras of the simulated room, a rig file");
    set.add("look", options.look, "only this person; empty: all");
    set.add("metaframes", options.metaframes, "in a row, of each motion", {2, 1000});
    const app::Start started =
        app::start({"geometry_steadiness",
                    "Measures how much the hulls of simulated people flicker: how the distance "
                    "between places of the body and the shape changes per metaframe.",
                    "  geometry_steadiness --look ada --metaframes 4\n"},
                   set,
                   argc,
                   argv);
    if (!started.go_on) return started.exit_code;
    fmt::print("look,motion,shape,mean_mm,p95_mm,out_mm,in_mm\n");
    for (const std::string& look : simulation::look_names()) {
        if (!options.look.empty() && look != options.look) continue;
        for (const char* motion : kMotions) measure(look, motion, options);
    }
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
