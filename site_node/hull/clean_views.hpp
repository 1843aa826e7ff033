#pragma once

#include "core/base/executor.hpp"
#include "site_node/hull/outlines.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// The checked input in canonical form, before jitter.
struct CleanViews {
    struct View {
        const SilhouetteView* source = nullptr;
        std::uint64_t hash = 0;
        std::size_t outlines_index = 0;
        OutlineCounts counts;
        HullStatus status = HullStatus::kOk;
    };
    std::vector<View> views;  // sorted by content, no two equal
    std::vector<Outlines> outlines;
    OutlineCounts counts;
    std::vector<OutlineScratch> scratch;  // one per worker of the executor
};

/// Checks `views` and brings them into canonical form, once per frame: cleans the contours, drops
/// those outside `options.bounds`, sorts the views by content and merges equal ones.
///
/// Adds to `hull.num_views_merged`; counts of contours are in `clean`. Runs on `executor`, one task
/// per view. Errors: kInvalidInput, kTooComplex, kTooFewViews (see `HullStatus`).
HullStatus clean_views(std::span<const SilhouetteView* const> views,
                       const HullOptions& options,
                       Executor& executor,
                       CleanViews& clean,
                       VisualHull& hull);

}  // namespace atrium::hull
