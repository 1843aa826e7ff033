#include "bench/hull/hull_scenes.hpp"
#include "core/base/thread_pool.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "tools/visual_hull/coverage.hpp"
#include "tools/visual_hull/recording_views.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

// Time of the hull's stages over the size of the input, as comma-separated values on standard
// output: `hull_curves segments|views|threads|sets|masks [repetitions]`. It computes all cases of a
// table in turn, repeatedly. A disturbance of the machine then affects all cases equally, and the
// minimum of each column counts.
namespace atrium::bench {
namespace {

struct Case {
    std::string name;  // of the first column
    std::vector<hull::SilhouetteView> views;
    std::size_t threads = 1;
    hull::VisualHull hull;
    hull::StageTimes least;
};

ThreadPool& pool_of(std::size_t threads) {
    static std::map<std::size_t, std::unique_ptr<ThreadPool>> pools;
    std::unique_ptr<ThreadPool>& pool = pools[threads];
    if (!pool) pool = std::make_unique<ThreadPool>(threads);
    return *pool;
}

void keep_least(const hull::StageTimes& times, hull::StageTimes& least) {
    least.silhouettes_ms = std::min(least.silhouettes_ms, times.silhouettes_ms);
    least.pencils_ms = std::min(least.pencils_ms, times.pencils_ms);
    least.sweep_ms = std::min(least.sweep_ms, times.sweep_ms);
    least.assembly_ms = std::min(least.assembly_ms, times.assembly_ms);
    least.total_ms = std::min(least.total_ms, times.total_ms);
}

void measure(std::vector<Case>& cases, int repetitions) {
    hull::HullScratch scratch;
    // one extra run, which allocates the memory before the counted ones
    for (int round = -1; round < repetitions; ++round) {
        for (Case& one : cases) {
            hull::compute_visual_hull(one.views, {}, scratch, pool_of(one.threads), one.hull);
            if (one.hull.status != hull::HullStatus::kOk) {
                std::fprintf(stderr,
                             "hull_curves: %s: %s\n",
                             one.name.c_str(),
                             hull::to_string(one.hull.status));
                std::exit(1);
            }
            if (round <= 0) one.least = one.hull.times;
            keep_least(one.hull.times, one.least);
        }
    }
}

void print_header(const char* first, const char* rest = "") {
    std::printf(
        "%s,views,segments,threads,triangles,silhouettes_ms,pencils_ms,sweep_ms,"
        "assembly_ms,total_ms%s\n",
        first,
        rest);
}

void print_row(const Case& one) {
    std::printf("%s,%zu,%zu,%zu,%zu,%.4f,%.4f,%.4f,%.4f,%.4f",
                one.name.c_str(),
                one.views.size(),
                num_segments(one.views),
                one.threads,
                one.hull.mesh.triangles.size(),
                one.least.silhouettes_ms,
                one.least.pencils_ms,
                one.least.sweep_ms,
                one.least.assembly_ms,
                one.least.total_ms);
}

void print_rows(const char* first, const std::vector<Case>& cases) {
    print_header(first);
    for (const Case& one : cases) {
        print_row(one);
        std::printf("\n");
    }
}

void run_segments(int repetitions) {
    std::vector<Case> cases;
    for (const int n : {20, 30, 45, 70, 100, 150, 220, 330, 500, 750, 1100})
        cases.push_back({std::to_string(n), person_views(8, n), 1, {}, {}});
    measure(cases, repetitions);
    print_rows("segments_per_view", cases);
}

void run_views(int repetitions) {
    std::vector<Case> cases;
    for (const int n : {4, 6, 8, 12, 16, 24, 32, 48, 64})
        cases.push_back({std::to_string(n), person_views(n, 250), 1, {}, {}});
    measure(cases, repetitions);
    print_rows("num_views", cases);
}

void run_threads(int repetitions) {
    std::vector<Case> cases;
    for (const int views : {8, 24}) {
        for (std::size_t threads = 1; threads <= std::thread::hardware_concurrency(); ++threads)
            cases.push_back(
                {"person_" + std::to_string(views), person_views(views, 280), threads, {}, {}});
    }
    measure(cases, repetitions);
    print_rows("scene", cases);
}

void run_sets(int repetitions) {
    std::vector<Case> cases;
    for (const std::string name : {"person_1px", "person_10k", "person_24views"}) {
        const auto views = shared_set(name);
        if (!views) {
            std::fprintf(stderr, "hull_curves: %s is not here and left out\n", name.c_str());
            continue;
        }
        for (const std::size_t threads : {1u, 2u}) cases.push_back({name, *views, threads, {}, {}});
    }
    measure(cases, repetitions);
    print_rows("set", cases);
}

// Evenly spaced cameras of a ring, as far as their number allows.
std::vector<hull::SilhouetteView> choose(const std::vector<views::NamedView>& all,
                                         std::size_t count) {
    std::vector<hull::SilhouetteView> chosen;
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * all.size() / count].view);
    return chosen;
}

void print_coverage(const Case& one) {
    hull_tool::CoverageScratch scratch;
    double sum = 0.0;
    double worst = 1.0;
    std::size_t excess_px = 0;
    for (const hull::SilhouetteView& view : one.views) {
        const auto coverage = hull_tool::measure_coverage(one.hull.mesh, view, scratch);
        sum += coverage.share();
        worst = std::min(worst, coverage.share());
        excess_px += coverage.excess_px;
    }
    std::printf(",%.2f,%.2f,%.2f,%zu,%u\n",
                1e3 * geometry::volume_m3(one.hull.mesh),
                100.0 * sum / static_cast<double>(one.views.size()),
                100.0 * worst,
                excess_px,
                one.hull.num_components);
}

void run_masks(int repetitions) {
    const std::map<std::string, std::vector<std::size_t>> recordings{{"ring20", {4, 8, 12, 20}},
                                                                     {"dancer", {8}}};
    std::vector<Case> cases;
    for (const auto& [name, counts] : recordings) {
        const auto all = hull_tool::load_recording_views(recording_folder(name), 0, {});
        if (!all) {
            std::fprintf(stderr, "hull_curves: %s\n", all.error().message.c_str());
            continue;
        }
        for (const std::size_t count : counts) {
            for (const std::size_t threads : {1u, 2u})
                cases.push_back({name, choose(*all, count), threads, {}, {}});
        }
    }
    measure(cases, repetitions);
    print_header("recording",
                 ",volume_l,coverage_mean_percent,coverage_worst_percent,excess_px,components");
    for (const Case& one : cases) {
        print_row(one);
        print_coverage(one);
    }
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) {
    using namespace atrium::bench;
    const std::map<std::string, std::function<void(int)>> tables{{"segments", run_segments},
                                                                 {"views", run_views},
                                                                 {"threads", run_threads},
                                                                 {"sets", run_sets},
                                                                 {"masks", run_masks}};
    const auto table = argc < 2 ? tables.end() : tables.find(argv[1]);
    const int repetitions = argc < 3 ? 10 : std::atoi(argv[2]);
    if (table == tables.end() || repetitions < 1) {
        std::fprintf(stderr,
                     "usage: hull_curves segments|views|threads|sets|masks [repetitions]\n");
        return 2;
    }
    table->second(repetitions);
    return 0;
}
