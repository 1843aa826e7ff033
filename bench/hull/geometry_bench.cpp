#include "bench/hull/hull_scenes.hpp"
#include "core/geometry/closed_mesh.hpp"
#include "core/geometry/decimate.hpp"
#include "tests/support/shapes/surface_distance.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <limits>

// Work on the hull of a person, of 10 k triangles: find and check neighbours, decimate, compute
// normals for display. `min_ms` is the fastest round.
namespace atrium::geometry {
namespace {

constexpr int kNumRandomPoints = 20'000;  // besides all vertices and middles

// Empty if ../shared/data is missing; then `state` is skipped.
const TriangleMesh& person(benchmark::State& state) {
    static const TriangleMesh mesh = [] {
        hull::HullScratch scratch;
        const auto views = bench::shared_set("person_10k");
        return views ? hull::compute_visual_hull(*views, {}, scratch).mesh : TriangleMesh{};
    }();
    if (mesh.empty()) state.SkipWithError("there is no ../shared/data/hulls/person_10k.json");
    return mesh;
}

class FastestRound {
public:
    template <typename Work>
    void time(const Work& work) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::milli> ms =
            std::chrono::steady_clock::now() - start;
        min_ms_ = std::min(min_ms_, ms.count());
    }
    double min_ms() const { return min_ms_; }

private:
    double min_ms_ = std::numeric_limits<double>::infinity();
};

// args: allowed distance [mm]. Counters: the remaining triangles, the reported bound, and the
// largest measured distance from either surface to the other.
void decimate_person(benchmark::State& state) {
    const TriangleMesh& in = person(state);
    const DecimateOptions options{.max_distance_m = 1e-3 * static_cast<double>(state.range(0))};
    DecimateScratch scratch;
    TriangleMesh out;
    FastestRound fastest;
    double bound_m = 0.0;
    for (auto _ : state) {
        fastest.time([&] {
            if (const auto report = decimate(in, options, scratch, out))
                bound_m = report->distance_bound_m;
        });
    }
    if (in.empty()) return;
    const double measured_m = std::max(test::SurfaceDistance(out).largest_m(in, kNumRandomPoints),
                                       test::SurfaceDistance(in).largest_m(out, kNumRandomPoints));
    state.counters["min_ms"] = fastest.min_ms();
    state.counters["triangles"] = static_cast<double>(out.triangles.size());
    state.counters["stated_mm"] = 1e3 * bound_m;
    state.counters["measured_mm"] = 1e3 * measured_m;
}
BENCHMARK(decimate_person)->ArgName("mm")->Arg(1)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

void normals_of_person(benchmark::State& state) {
    const TriangleMesh& mesh = person(state);
    FastestRound fastest;
    for (auto _ : state) fastest.time([&] { benchmark::DoNotOptimize(vertex_normals(mesh)); });
    state.counters["min_ms"] = fastest.min_ms();
}
BENCHMARK(normals_of_person)->Unit(benchmark::kMillisecond);

void neighbours_of_person(benchmark::State& state) {
    const TriangleMesh& mesh = person(state);
    ClosedMesh surface;
    FastestRound fastest;
    for (auto _ : state) {
        fastest.time([&] {
            if (!surface.assign(mesh)) state.SkipWithError("not closed");
        });
    }
    state.counters["min_ms"] = fastest.min_ms();
}
BENCHMARK(neighbours_of_person)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace atrium::geometry

BENCHMARK_MAIN();
