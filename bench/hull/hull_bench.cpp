#include "core/base/thread_pool.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/views/views_file.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>

// Time of one exact hull. Counters: milliseconds of each stage in the fastest round, and the size
// of the result.
namespace atrium::hull {
namespace {

const std::filesystem::path kSets = ATRIUM_SOURCE_DIR "/../shared/data/hulls";

// If the set is missing, a body with as many segments as a real one: an uneven star from each
// camera.
std::vector<SilhouetteView> synthetic_body(int num_cameras, int num_vertices) {
    std::vector<SilhouetteView> views;
    for (const auto& camera : test::make_ring_rig({.num_cameras = num_cameras})) {
        test::Contour contour =
            test::outline_of(test::Sphere{{0.0, 0.0, 0.9}, 0.6}, camera, num_vertices);
        const Eigen::Vector2d centre(499.5, 499.5);
        for (std::size_t i = 0; i < contour.size(); ++i) {
            const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / num_vertices;
            contour[i] = centre + (0.8 + 0.2 * std::cos(5.0 * angle)) * (contour[i] - centre);
        }
        views.push_back(test::make_view(camera, {contour}));
    }
    return views;
}

const std::vector<SilhouetteView>& scene(const std::string& name) {
    static std::map<std::string, std::vector<SilhouetteView>> cache;
    std::vector<SilhouetteView>& views = cache[name];
    if (!views.empty()) return views;
    const std::filesystem::path file = kSets / (name + ".json");
    if (std::filesystem::exists(file)) {
        const auto loaded = views::load_views_file(file);
        if (loaded) {
            for (const auto& view : *loaded) views.push_back(view.view);
            return views;
        }
    }
    return views = name == "person_24views" ? synthetic_body(24, 208) : synthetic_body(8, 280);
}

void hull_of(benchmark::State& state, const std::string& name) {
    const std::vector<SilhouetteView>& views = scene(name);
    ThreadPool pool(static_cast<std::size_t>(state.range(0)));
    HullScratch scratch;
    VisualHull hull;
    StageTimes fastest;
    fastest.total_ms = 1e9;
    for (auto _ : state) {
        compute_visual_hull(views, {}, scratch, pool, hull);
        if (hull.times.total_ms < fastest.total_ms) fastest = hull.times;
    }
    if (hull.status != HullStatus::kOk) state.SkipWithError(to_string(hull.status));
    state.counters["min_ms"] = fastest.total_ms;
    state.counters["silhouettes_ms"] = fastest.silhouettes_ms;
    state.counters["pencils_ms"] = fastest.pencils_ms;
    state.counters["sweep_ms"] = fastest.sweep_ms;
    state.counters["assembly_ms"] = fastest.assembly_ms;
    state.counters["triangles"] = static_cast<double>(hull.mesh.triangles.size());
}

BENCHMARK_CAPTURE(hull_of, person_10k, std::string("person_10k"))
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(hull_of, person_24views, std::string("person_24views"))
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace atrium::hull

BENCHMARK_MAIN();
