#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/aabb.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace atrium::hull {

/// A part of a large space with the cameras that watch it. One hull is computed in each region,
/// from its own cameras and with silhouettes outside of it left out, so that people in different
/// regions neither multiply each other's cost nor make phantoms with each other: the paper's "3D
/// models computed per subsets of cameras".
struct Region {
    std::string name;
    geometry::Aabb bounds;             // site frame [m]; regions should not overlap
    std::vector<std::uint32_t> views;  // indices of its cameras; empty: all
    std::uint32_t min_views = 1;       // a hull needs at least so many of its cameras
};

struct RegionScratch {
    HullScratch hull;
    VisualHull part;
    std::vector<const SilhouetteView*> views;
};

/// The hulls of all regions as one mesh; a body that stands across the border of two regions is cut
/// there. Counts and times are sums.
///
/// `views[i]` may be null: that camera delivered nothing, and the others go on. `options.bounds` is
/// replaced by each region's. Status: kOk if any region has somebody, else a failure if any region
/// failed, else kEmptyIntersection. A region that fails beside others that do not is left out and
/// counted in `num_regions_failed`; so is a region with fewer than `min_views` cameras present
/// (kTooFewViews).
///
/// Errors: kInvalidInput for a region that names a view that is not there.
void compute_region_hulls(std::span<const SilhouetteView* const> views,
                          std::span<const Region> regions,
                          const HullOptions& options,
                          RegionScratch& scratch,
                          Executor& executor,
                          VisualHull& hull);

}  // namespace atrium::hull
