#pragma once

#include "core/base/executor.hpp"
#include "site_node/hull/outlines.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// The input in canonical form, checked, before any jitter.
struct CleanViews {
    struct View {
        const SilhouetteView* source = nullptr;
        std::uint64_t hash = 0;
        std::size_t outlines_index = 0;
        OutlineCounts counts;
        HullStatus status = HullStatus::kOk;
    };
    std::vector<View> views;  // sorted by content
    std::vector<Outlines> outlines;
    OutlineCounts counts;
    std::vector<OutlineScratch> scratch;  // one per worker
};

/// Once per frame. kOk, or what is wrong with the input.
HullStatus clean_views(std::span<const SilhouetteView* const> views,
                       const HullOptions& options,
                       Executor& executor,
                       CleanViews& clean,
                       VisualHull& hull);

}  // namespace atrium::hull
