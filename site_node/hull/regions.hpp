#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/aabb.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace atrium::hull {

/// A part of a large space, with the cameras that watch it. Each region gets its own hull, computed
/// from its own cameras without the silhouettes outside it. People in different regions then
/// neither multiply each other's cost nor form phantoms together. Source: Petit et al. (2010), "3D
/// models computed per subsets of cameras".
struct Region {
    std::string name;
    geometry::Aabb bounds;             // site frame [m]; regions should not overlap
    std::vector<std::uint32_t> views;  // indices of its cameras; empty: all
    std::uint32_t min_delivered = 1;   // with fewer views delivered it has no hull
    bool is_elsewhere = false;         // another host computes it
};

struct RegionScratch {
    HullScratch hull;
    std::vector<VisualHull> parts;  // the hull of each region
    std::vector<const SilhouetteView*> views;
};

/// Computes the hulls of all regions, `scratch.parts`, and joins them into one mesh. A body across
/// the border of two regions is cut there. Counts and times are sums. A region elsewhere has an
/// empty part.
///
/// `views[i]` may be null: the camera has delivered nothing, and the others are used.
/// `options.bounds` is replaced by the bounds of each region. A region that fails beside successful
/// ones is left out and counted in `num_regions_failed`; so is a region with fewer than
/// `min_delivered` cameras present (kTooFewViews).
///
/// Status: kOk if any region has a hull; otherwise the last failure of a region; otherwise
/// kEmptyIntersection. kInvalidInput if a region names a view that does not exist.
void compute_region_hulls(std::span<const SilhouetteView* const> views,
                          std::span<const Region> regions,
                          const HullOptions& options,
                          RegionScratch& scratch,
                          Executor& executor,
                          VisualHull& hull);

}  // namespace atrium::hull
