// Counts what goes wrong with the shapes of several simulated people, metaframe by metaframe: parts
// of the shape that are nobody (phantoms), and parts of bodies that no shape has (lost limbs).
// geometry_people.sh keeps the rows and makes the table of docs/measurements/hull.md.
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

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

using geometry::SurfaceTree;
using geometry::TriangleMesh;

constexpr double kLost_m = 0.05;  // a place of a body this far outside of the shape is lost

struct Options {
    std::filesystem::path rig = ATRIUM_SOURCE_DIR "/deploy/rigs/full_body_1mp.toml";
    std::string look;  // of the first person; empty: the first two looks
    int people = 2;
    double back_m = 1.5;  // the cameras stand this much farther back: people must fit into pictures
    int metaframes = 90;  // of each motion; the loop lasts 90
};

// The connected parts of a mesh.
std::vector<TriangleMesh> components(const TriangleMesh& mesh) {
    std::vector<std::uint32_t> root(mesh.vertices.size());
    std::iota(root.begin(), root.end(), 0U);
    const auto find = [&](std::uint32_t v) {
        while (root[v] != v) v = root[v] = root[root[v]];
        return v;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
        root[find(a)] = find(b);
        root[find(b)] = find(c);
    }
    std::map<std::uint32_t, TriangleMesh> parts;
    for (const auto& triangle : mesh.triangles) {
        TriangleMesh& part = parts[find(triangle[0])];
        std::array<std::uint32_t, 3> own;
        for (std::size_t k = 0; k < 3; ++k) {  // corners are not shared: winding needs no more
            own[k] = static_cast<std::uint32_t>(part.vertices.size());
            part.vertices.push_back(mesh.vertices[triangle[k]]);
        }
        part.triangles.push_back(own);
    }
    std::vector<TriangleMesh> all;
    for (auto& [vertex, part] : parts) all.push_back(std::move(part));
    return all;
}

// Whether less than a tenth of the component lies inside a body.
bool is_phantom(const TriangleMesh& component, const std::vector<SurfaceTree>& bodies) {
    constexpr int kNumPoints = 60;
    constexpr int kMostTries = 20'000;
    const SurfaceTree tree(component);
    const geometry::Aabb box = tree.box();
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    int num = 0;
    int num_real = 0;
    for (int i = 0; i < kMostTries && num < kNumPoints; ++i) {
        const Eigen::Vector3d shares(share(random), share(random), share(random));
        const Eigen::Vector3d at = box.min + shares.cwiseProduct(box.max - box.min);
        if (tree.winding_number(at) < 0.5) continue;
        ++num;
        num_real += std::ranges::any_of(
            bodies, [&](const SurfaceTree& body) { return body.winding_number(at) > 0.5; });
    }
    return 10 * num_real < num || num == 0;
}

struct Count {
    int num_phantoms = 0;
    double phantoms_l = 0.0;       // the largest
    int num_lost = 0;              // metaframes in which a part of a body is lost
    double most_missing_mm = 0.0;  // distance of a place of a body from the shape, outside of it
};

void judge(const TriangleMesh& shape,
           const std::vector<TriangleMesh>& skins,
           const std::vector<SurfaceTree>& bodies,
           Count& count) {
    constexpr std::size_t kEvery = 7;  // vertex of a skin
    for (const TriangleMesh& component : components(shape)) {
        if (!is_phantom(component, bodies)) continue;
        ++count.num_phantoms;
        count.phantoms_l = std::max(count.phantoms_l, 1e3 * geometry::volume_m3(component));
    }
    const SurfaceTree tree(shape);
    double farthest_m = 0.0;
    for (const TriangleMesh& skin : skins) {
        for (std::size_t v = 0; v < skin.vertices.size(); v += kEvery) {
            if (tree.winding_number(skin.vertices[v]) > 0.5) continue;
            farthest_m = std::max(farthest_m, tree.distance_m(skin.vertices[v]));
        }
    }
    count.most_missing_mm = std::max(count.most_missing_mm, 1e3 * farthest_m);
    if (farthest_m > kLost_m) ++count.num_lost;
}

void measure(const std::string& look, const std::string& motion, const Options& options) {
    simulation::RoomOptions room_options;
    room_options.look = look;
    room_options.motion = motion;
    room_options.num_people = options.people;
    auto rig = value_of(config::load_rig(options.rig));
    for (geometry::CalibratedCamera& camera : rig.cameras)
        camera.camera_from_site.translation.z() += options.back_m;
    auto room = value_of(simulation::RoomRenderer::create(rig.cameras, room_options));
    hull::HullScratch scratch;
    hull::CornerRounding rounding;
    refine::PhotoRefinement photo;
    refine::PhotoRefinement round_photo;
    SerialExecutor executor;
    std::map<std::string, Count> counts;
    for (int i = 0; i < options.metaframes; ++i) {
        const double time_s = room_options.frame_time_s(i);
        const FilmedInstant instant = film(room, time_s);
        std::vector<TriangleMesh> skins;
        std::vector<SurfaceTree> bodies;
        for (int person = 0; person < options.people; ++person) {
            const double own_s = simulation::time_of_person_s(room_options, person, time_s);
            skins.push_back(room.person(static_cast<std::size_t>(person)).mesh(own_s));
            bodies.emplace_back(skins.back());
        }
        const TriangleMesh hull = hull_of(instant, scratch, look + " " + motion);
        judge(hull, skins, bodies, counts["hull"]);
        const std::vector<refine::PictureView> views = instant.picture_views(room.cameras());
        TriangleMesh mesh = hull;
        photo.refine(mesh, views, executor);
        judge(mesh, skins, bodies, counts["photo"]);
        mesh = hull;
        rounding.round(mesh, instant.silhouette_pointers());
        round_photo.refine(mesh, views, executor);
        judge(mesh, skins, bodies, counts["round_photo"]);
    }
    for (const char* shape : {"hull", "photo", "round_photo"}) {
        const Count& count = counts[shape];
        fmt::print("{},{},{},{},{},{:.3f},{},{:.1f}\n",
                   look,
                   motion,
                   shape,
                   options.metaframes,
                   count.num_phantoms,
                   count.phantoms_l,
                   count.num_lost,
                   count.most_missing_mm);
        std::fflush(stdout);
    }
}

int run(int argc, char** argv) {
    Options options;
    config::OptionSet set;
    set.add("rig", options.rig, "cameras of the simulated room, a rig file");
    set.add("look", options.look, "of the first person; empty: the first two looks in turn");
    set.add("people", options.people, "in the room", {1, simulation::kMaxPeople});
    set.add("back-m",
            options.back_m,
            "farther back than in the rig, so that all people are in the pictures",
            {0.0, 10.0});
    set.add("metaframes", options.metaframes, "of each motion", {1, 10'000});
    const app::Start started =
        app::start({"geometry_people",
                    "Counts phantoms and lost limbs in the shapes of several simulated people.",
                    "  geometry_people --people 2 --look ada --metaframes 10\n"},
                   set,
                   argc,
                   argv);
    if (!started.go_on) return started.exit_code;
    fmt::print("look,motion,shape,metaframes,phantoms,phantom_l,lost,missing_mm\n");
    std::vector<std::string> looks = {options.look};
    if (options.look.empty()) {
        looks = simulation::look_names();
        looks.resize(2);
    }
    for (const std::string& look : looks)
        for (const char* motion : kMotions) measure(look, motion, options);
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
