#include "site_node/hull/visual_hull.hpp"

#include "site_node/hull/cones.hpp"
#include "site_node/hull/mesh_assembly.hpp"
#include "site_node/hull/needed_components.hpp"
#include "site_node/hull/pencils.hpp"
#include "site_node/hull/strip_sweep.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>

namespace atrium::hull {
namespace {

// Strips per run: enough to amortise its start, few enough to keep many workers busy. It fixes the
// order of the result, so it does not depend on the number of workers.
constexpr std::uint32_t kStripsPerRun = 96;

constexpr std::uint32_t kMaxAttempts = 6;  // jitter from 1e-6 to 1e-1 px

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point& mark) {
    const Clock::time_point now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - mark).count();
    mark = now;
    return ms;
}

}  // namespace

struct HullScratch::Data {
    std::vector<const SilhouetteView*> views;
    CleanViews clean;
    ConeScratch cone;
    Cones cones;
    Pencils pencils;
    std::vector<StripRun> runs;
    std::vector<RunFaces> faces;     // one per run
    std::vector<StripSweep> sweeps;  // one per worker
    MeshAssembly assembly;
    NeededComponents needed;
    std::uint64_t steps_left = 0;            // for the remaining attempts
    std::uint32_t num_dropped_at_first = 0;  // contours dropped by the first attempt
};

HullScratch::HullScratch() : data_(std::make_unique<Data>()) {}
HullScratch::~HullScratch() = default;
HullScratch::HullScratch(HullScratch&&) noexcept = default;
HullScratch& HullScratch::operator=(HullScratch&&) noexcept = default;

namespace {

void plan_runs(const Cones& cones, std::vector<StripRun>& runs) {
    runs.clear();
    for (const Cones::Chain& chain : cones.chains) {
        const std::uint32_t n = chain.last_strip - chain.first_strip;
        const std::uint32_t parts = (n + kStripsPerRun - 1) / kStripsPerRun;
        for (std::uint32_t part = 0; part < parts; ++part) {
            const auto first_of = [&](std::uint64_t p) {
                return static_cast<std::uint32_t>(n * p / parts);
            };
            runs.push_back(
                {chain.first_strip + first_of(part), first_of(part + 1) - first_of(part)});
        }
    }
}

struct SweepOutcome {
    bool failed = false;
    bool unbounded = false;
    bool too_complex = false;
};

SweepOutcome sweep_all(HullScratch::Data& data, Executor& executor) {
    plan_runs(data.cones, data.runs);
    if (data.faces.size() < data.runs.size()) data.faces.resize(data.runs.size());
    if (data.sweeps.size() < executor.num_workers()) data.sweeps.resize(executor.num_workers());
    // runs need unequal numbers of steps: four times the mean per run still bounds the total
    const std::uint64_t max_steps =
        4 * data.steps_left / std::max<std::size_t>(data.runs.size(), 1) + 100'000;
    std::atomic<bool> is_too_complex = false;  // takes precedence over all other outcomes
    const auto sweep_run = [&](std::size_t task, std::size_t worker) {
        if (is_too_complex.load(std::memory_order_relaxed)) {
            data.faces[task].clear();
            return;
        }
        data.sweeps[worker].run(
            data.cones, data.pencils, data.runs[task], max_steps, data.faces[task]);
        if (data.faces[task].num_steps > max_steps) is_too_complex = true;
    };
    executor.parallel_for(data.runs.size(), sweep_run);
    SweepOutcome outcome;
    for (std::size_t r = 0; r < data.runs.size(); ++r) {
        data.steps_left -= std::min(data.steps_left, data.faces[r].num_steps);
        outcome.failed |= data.faces[r].failed;
        outcome.unbounded |= data.faces[r].unbounded;
    }
    outcome.too_complex = is_too_complex;
    return outcome;
}

// One attempt with one jitter. kNumericFailure: the next attempt may succeed.
HullStatus attempt(HullScratch::Data& data,
                   const HullOptions& options,
                   std::uint32_t number,
                   Executor& executor,
                   VisualHull& hull) {
    Clock::time_point mark = Clock::now();
    const HullStatus built =
        build_cones(data.clean, options, number, executor, data.cone, data.cones, hull);
    hull.times.silhouettes_ms += ms_since(mark);
    if (number == 0) data.num_dropped_at_first = hull.num_contours_dropped;
    // a jitter that destroys outlines would change the input
    if (hull.num_contours_dropped > data.num_dropped_at_first) return HullStatus::kNumericFailure;
    if (built != HullStatus::kOk) return built;
    const bool is_general = build_pencils(data.cones, executor, data.pencils);
    hull.times.pencils_ms += ms_since(mark);
    if (!is_general) return HullStatus::kNumericFailure;
    const SweepOutcome outcome = sweep_all(data, executor);
    hull.times.sweep_ms += ms_since(mark);
    if (outcome.too_complex) return HullStatus::kTooComplex;
    if (outcome.failed) return HullStatus::kNumericFailure;
    if (outcome.unbounded) return HullStatus::kUnbounded;
    const std::span<const RunFaces> faces(data.faces.data(), data.runs.size());
    const bool is_sound = data.assembly.assemble(data.cones, faces, options, executor, hull);
    if (is_sound && !options.keep_phantoms) data.needed.keep_only(data.clean.views, executor, hull);
    hull.times.assembly_ms += ms_since(mark);
    if (!is_sound) return HullStatus::kNumericFailure;
    return hull.mesh.empty() ? HullStatus::kEmptyIntersection : HullStatus::kOk;
}

}  // namespace

void clear(VisualHull& hull) {
    geometry::TriangleMesh mesh = std::move(hull.mesh);
    mesh.clear();
    hull = VisualHull{};
    hull.mesh = std::move(mesh);
}

const Cones& intersected_cones(const HullScratch& scratch) { return scratch.data().cones; }

const char* to_string(HullStatus status) {
    switch (status) {
        case HullStatus::kOk:
            return "ok";
        case HullStatus::kTooFewViews:
            return "too few views";
        case HullStatus::kEmptyIntersection:
            return "empty intersection";
        case HullStatus::kUnbounded:
            return "unbounded";
        case HullStatus::kInvalidInput:
            return "invalid input";
        case HullStatus::kTooComplex:
            return "too complex";
        case HullStatus::kNumericFailure:
            return "numeric failure";
    }
    return "unknown";
}

void compute_visual_hull(std::span<const SilhouetteView> views,
                         const HullOptions& options,
                         HullScratch& scratch,
                         Executor& executor,
                         VisualHull& hull) {
    std::vector<const SilhouetteView*>& pointers = scratch.data().views;
    pointers.clear();
    for (const SilhouetteView& view : views) pointers.push_back(&view);
    compute_visual_hull(
        std::span<const SilhouetteView* const>(pointers), options, scratch, executor, hull);
}

void compute_visual_hull(std::span<const SilhouetteView* const> views,
                         const HullOptions& options,
                         HullScratch& scratch,
                         Executor& executor,
                         VisualHull& hull) {
    clear(hull);
    HullScratch::Data& data = scratch.data();
    Clock::time_point start = Clock::now();
    Clock::time_point mark = start;
    hull.status = clean_views(views, options, executor, data.clean, hull);
    hull.times.silhouettes_ms = ms_since(mark);
    data.steps_left = options.max_steps;
    if (hull.status == HullStatus::kOk) {
        do {
            hull.status = attempt(data, options, hull.num_attempts, executor, hull);
        } while (++hull.num_attempts < kMaxAttempts && hull.status == HullStatus::kNumericFailure);
    }
    hull.times.total_ms = ms_since(start);
}

VisualHull compute_visual_hull(std::span<const SilhouetteView> views,
                               const HullOptions& options,
                               HullScratch& scratch) {
    VisualHull hull;
    SerialExecutor executor;
    compute_visual_hull(views, options, scratch, executor, hull);
    return hull;
}

}  // namespace atrium::hull
