#include "site_node/hull/regions.hpp"

#include <utility>

namespace atrium::hull {
namespace {

// False if the region names a view that does not exist.
bool choose_views(std::span<const SilhouetteView* const> views,
                  const Region& region,
                  std::vector<const SilhouetteView*>& chosen) {
    chosen.clear();
    if (region.views.empty()) {
        for (const SilhouetteView* view : views) {
            if (view != nullptr) chosen.push_back(view);
        }
        return true;
    }
    for (const std::uint32_t v : region.views) {
        if (v >= views.size()) return false;
        if (views[v] != nullptr) chosen.push_back(views[v]);
    }
    return true;
}

void add_times(const StageTimes& part, StageTimes& sum) {
    sum.silhouettes_ms += part.silhouettes_ms;
    sum.pencils_ms += part.pencils_ms;
    sum.sweep_ms += part.sweep_ms;
    sum.assembly_ms += part.assembly_ms;
    sum.total_ms += part.total_ms;
}

void add_part(const VisualHull& part, VisualHull& hull) {
    geometry::append(hull.mesh, part.mesh);
    hull.num_components += part.num_components;
    hull.num_phantoms_dropped += part.num_phantoms_dropped;
    hull.num_fragments_dropped += part.num_fragments_dropped;
    hull.volume_dropped_m3 += part.volume_dropped_m3;
    hull.num_contours_dropped += part.num_contours_dropped;
    hull.num_contours_repaired += part.num_contours_repaired;
    hull.num_views_merged += part.num_views_merged;
    hull.num_attempts += part.num_attempts;
    add_times(part.times, hull.times);
}

}  // namespace

void compute_region_hulls(std::span<const SilhouetteView* const> views,
                          std::span<const Region> regions,
                          const HullOptions& options,
                          RegionScratch& scratch,
                          Executor& executor,
                          VisualHull& hull) {
    clear(hull);
    hull.status = HullStatus::kEmptyIntersection;
    HullStatus failure = HullStatus::kEmptyIntersection;
    HullOptions region_options = options;
    scratch.parts.resize(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const Region& region = regions[r];
        VisualHull& part = scratch.parts[r];
        clear(part);
        part.status = HullStatus::kEmptyIntersection;
        if (region.is_elsewhere) continue;
        if (!choose_views(views, region, scratch.views)) {
            clear(hull);
            hull.status = HullStatus::kInvalidInput;
            return;
        }
        if (scratch.views.size() < region.min_delivered) {
            part.status = HullStatus::kTooFewViews;
        } else {
            region_options.bounds = region.bounds;
            compute_visual_hull(scratch.views, region_options, scratch.hull, executor, part);
        }
        const HullStatus status = part.status;
        add_part(part, hull);
        if (status == HullStatus::kOk) {
            hull.status = HullStatus::kOk;
        } else if (status != HullStatus::kEmptyIntersection) {
            ++hull.num_regions_failed;
            failure = status;
        }
    }
    const auto num_own =
        std::ranges::count_if(regions, [](const Region& region) { return !region.is_elsewhere; });
    // nobody is in the others
    if (hull.status != HullStatus::kOk && std::cmp_equal(hull.num_regions_failed, num_own))
        hull.status = failure;
}

}  // namespace atrium::hull
