#pragma once

#include "site_node/hull/outlines.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// The viewing cones of all views.
///
/// Ray g starts at its camera's centre and passes through silhouette point g; strip g is the sector
/// of a plane between ray g and ray next[g]. Ids run through all views, contour by contour. Strip
/// ids name everything else: a vertex of the hull is the unordered triple of the strips that meet
/// in it.
struct Cones {
    struct View {
        Eigen::Vector3d centre;            // site frame [m], relative to `origin`
        Eigen::Vector3d axis;              // viewing direction, site frame
        Eigen::Matrix3d camera_from_site;  // rotation only
        geometry::PinholeCamera intrinsics;
        std::uint32_t first = 0;  // rays [first, last)
        std::uint32_t last = 0;
    };
    std::vector<View> views;
    std::vector<Outlines> outlines;  // what was really intersected, view by view
    Eigen::Vector3d origin;          // mean of the camera centres, site frame

    std::vector<Eigen::Vector3d> ray;     // site frame; depth 1 along the camera's axis
    std::vector<Eigen::Vector3d> normal;  // of strip g, outwards
    std::vector<std::uint32_t> next;
    std::vector<std::uint32_t> prev;
    std::vector<std::uint32_t> contour;  // counted through all views
    std::vector<std::uint8_t> view_of;

    std::size_t num_views() const { return views.size(); }
    /// Bit k: centre of view i lies inside cone k. Bit i is set.
    std::uint64_t views_around_centre(std::size_t i) const;
};

/// The input in canonical form, checked, before any jitter.
struct CleanViews {
    struct View {
        const SilhouetteView* source = nullptr;
        std::uint64_t hash = 0;
        std::size_t outlines_index = 0;
    };
    std::vector<View> views;  // sorted by content
    std::vector<Outlines> outlines;
};

struct ConeScratch {
    CleanViews clean;
    OutlineScratch outline;
    OutlineCounts clean_counts;
};

/// Step 1, once per frame. kOk, or what is wrong with the input.
HullStatus clean_views(std::span<const SilhouetteView> views,
                       const HullOptions& options,
                       ConeScratch& scratch,
                       VisualHull& hull);

/// Step 2, once per attempt: jitter, simple polygons, rays.
HullStatus build_cones(const HullOptions& options,
                       std::uint32_t attempt,
                       ConeScratch& scratch,
                       Cones& cones,
                       VisualHull& hull);

/// The cones of the last computation with `scratch`, for checks from outside.
const Cones& intersected_cones(const HullScratch& scratch);

}  // namespace atrium::hull
