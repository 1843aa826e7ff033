#include "tools/calibrate/wand/lateness.hpp"

#include "core/base/median.hpp"
#include "tools/calibrate/adjust/place_camera.hpp"
#include "tools/calibrate/adjust/place_wands.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace atrium::calibrate {
namespace {

constexpr double kMoves_px = 2.0;  // between instants; slower motion tells no lateness
constexpr int kMostInstants = 3;
constexpr double kFits_px = 1.0;
constexpr int kIterations = 15;

// The sightings of a camera, moved to the instants `late` before.
void move_back(const WandSolution& solution, std::size_t camera, int late, Bundle& bundle) {
    const auto& instants = solution.instants;
    std::erase_if(bundle.sightings, [&](Sighting& sighting) {
        if (sighting.camera != camera) return false;
        const std::int64_t index = static_cast<std::int64_t>(sighting.instant) - late;
        if (index < 0 || index >= static_cast<std::int64_t>(instants.size())) return true;
        const auto moved = static_cast<std::uint32_t>(index);
        if (static_cast<std::int64_t>(instants[moved]) !=
            static_cast<std::int64_t>(instants[sighting.instant]) - late)
            return true;
        sighting.instant = moved;
        sighting.is_used = true;
        return !bundle.wands[moved].is_placed;
    });
    std::ranges::stable_sort(bundle.sightings, [](const Sighting& a, const Sighting& b) {
        return a.instant != b.instant ? a.instant < b.instant : a.camera < b.camera;
    });
}

std::size_t num_fitting(const Bundle& bundle, std::size_t camera) {
    return static_cast<std::size_t>(
        std::ranges::count_if(bundle.sightings, [&](const Sighting& sighting) {
            return sighting.camera == camera && error_px(bundle, sighting).norm() <= kFits_px;
        }));
}

}  // namespace

double small_lateness(const WandSolution& solution, std::size_t camera) {
    const Bundle& bundle = solution.bundle;
    std::vector<double> late;
    for (const Sighting& sighting : bundle.sightings) {
        const std::size_t i = sighting.instant;
        if (sighting.camera != camera || i == 0 || i + 1 >= bundle.wands.size()) continue;
        if (!bundle.wands[i - 1].is_placed || !bundle.wands[i + 1].is_placed) continue;
        if (solution.instants[i + 1] != solution.instants[i - 1] + 2) continue;
        Sighting before = sighting, after = sighting;
        before.instant = sighting.instant - 1;
        after.instant = sighting.instant + 1;
        const BundleCamera& seen_by = bundle.cameras[camera];
        const Eigen::Vector2d motion = 0.5 * (project(seen_by, light_world(bundle, after)) -
                                              project(seen_by, light_world(bundle, before)));
        const Eigen::Vector2d error = error_px(bundle, sighting);
        if (!motion.allFinite() || !error.allFinite() || motion.norm() < kMoves_px) continue;
        late.push_back(-error.dot(motion) / motion.squaredNorm());
    }
    return median_of(std::move(late));
}

double large_lateness(const WandSolution& solution,
                      std::size_t camera,
                      const BundleCamera& nominal,
                      int num_threads) {
    std::size_t most = num_fitting(solution.bundle, camera);
    double best = small_lateness(solution, camera);
    for (int late = -kMostInstants; late <= kMostInstants; ++late) {
        WandSolution tried = solution;
        Bundle& bundle = tried.bundle;
        move_back(solution, camera, late, bundle);
        bundle.cameras[camera] = nominal;
        const std::vector<InstantRange> ranges = ranges_of(bundle);
        std::vector<std::uint32_t> instants;
        for (std::uint32_t i = 0; i < bundle.wands.size(); ++i)
            if (bundle.wands[i].is_placed) instants.push_back(i);
        if (!place_camera(bundle, camera, ranges, instants)) continue;
        AdjustOptions adjustment;
        adjustment.lens = LensFreedom::kRadial;
        adjustment.robust_px = kFits_px;
        adjustment.max_iterations = kIterations;
        adjustment.num_threads = num_threads;
        if (!adjust(bundle, adjustment)) continue;
        const std::size_t num = num_fitting(bundle, camera);
        if (num <= most) continue;
        most = num;
        best = late + small_lateness(tried, camera);
    }
    return best;
}

}  // namespace atrium::calibrate
