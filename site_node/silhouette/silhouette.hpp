#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "site_node/silhouette/contours.hpp"
#include "site_node/silhouette/edge_conflicts.hpp"
#include "site_node/silhouette/outline.hpp"
#include "site_node/silhouette/silhouette_polygon.hpp"

#include <cstdint>
#include <vector>

namespace atrium::silhouette {

struct SilhouetteOptions {
    /// Width of the blurred segments; at least 0.25. A person then lies in its hull up to a pixel.
    double tolerance_px = 0.75;
    std::int64_t min_area_px = 100;  // blobs and holes that enclose fewer pixels are skipped
};

/// Counts the contours of one mask that were skipped.
struct SilhouetteCounts {
    std::uint32_t num_small = 0;  // enclose fewer than min_area_px pixels
    /// Reach where the lens model has no inverse, or lie inside such a contour.
    std::uint32_t num_not_undistorted = 0;
    /// Cross themselves even when fully refined (never observed).
    std::uint32_t num_not_simple = 0;
    /// A polygon in the result runs along the picture border: the subject may continue outside.
    bool touches_border = false;
};

/// Reusable memory; one per thread.
struct SilhouetteScratch {
    ContourSet contours;
    OutlineScratch outline;
    EdgeGrid grid;
    std::vector<Outline> outlines;            // per contour
    std::vector<SilhouettePolygon> polygons;  // per contour
    std::vector<std::vector<std::uint32_t>>
        segments_of_edges;              // per contour: outline segment of each polygon edge
    std::vector<std::uint8_t> dropped;  // per contour
    std::vector<EdgeConflict> conflicts;
    std::vector<SilhouettePolygon> spare;  // memory of former polygons
};

/// Converts a mask, as the camera delivers it, into polygons in undistorted pixels.
///
/// `out` receives simple polygons that do not meet each other, blobs and holes, an outer one before
/// those inside it. Even-odd parity over all of them is the foreground. At the picture border
/// polygons are closed along the border. Each contour point lies within `tolerance_px` of its
/// polygon; the area equals that of the mask, without bias (outline.hpp). Lens distortion bends
/// chords: they are subdivided until the error is below 0.1 px. Deterministic; allocates only while
/// `scratch` and `out` grow. `mask` must have the size of the camera's picture; `rows` as in
/// trace_contours.
SilhouetteCounts extract_silhouette(const image::Mask& mask,
                                    const geometry::PinholeCamera& intrinsics,
                                    const SilhouetteOptions& options,
                                    SilhouetteScratch& scratch,
                                    std::vector<SilhouettePolygon>& out,
                                    std::span<const image::PixelSpan> rows = {});

/// Returns the signed area: positive for counter-clockwise polygons, with +Y up.
double signed_area_px(const SilhouettePolygon& polygon);

}  // namespace atrium::silhouette
