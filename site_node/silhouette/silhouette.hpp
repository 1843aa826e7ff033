#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "site_node/silhouette/contours.hpp"
#include "site_node/silhouette/outline.hpp"
#include "site_node/silhouette/silhouette_polygon.hpp"
#include "site_node/silhouette/simplicity.hpp"

#include <cstdint>
#include <vector>

namespace atrium::silhouette {

struct SilhouetteOptions {
    double tolerance_px = 0.75;  // width of the blurred segments; at least 0.25. A person then lies
                                 // in its hull up to a pixel
    std::int64_t min_area_px = 100;  // blobs and holes that enclose fewer pixels are left out
};

/// What became of the contours of one mask.
struct SilhouetteCounts {
    std::uint32_t num_small = 0;  // left out: enclose fewer than min_area_px pixels
    std::uint32_t num_not_undistorted =
        0;  // left out: reach where the lens model has no inverse, or lie inside such a one
    std::uint32_t num_not_simple =
        0;  // left out: still crossed itself when fully refined (not seen so far)
    bool touches_border = false;  // a polygon in the result runs along the picture's border: the
                                  // subject may go on outside
};

/// Reused memory; one per thread.
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
    std::vector<SilhouettePolygon> spare;  // memory of polygons that there were
};

/// Turns a mask, as the camera delivers it, into polygons in undistorted pixels.
///
/// `out` receives simple polygons that do not meet each other, blobs and holes, an
/// outer one before those inside it. Even-odd parity over all of them is the foreground. At the
/// picture's border polygons are closed along the border. Each contour point lies within
/// `tolerance_px` of its polygon; the area is that of the mask, without bias (outline.hpp). Lens
/// distortion bends chords: they are subdivided until what is left is below 0.1 px. Deterministic;
/// allocates only while `scratch` and `out` grow. `mask` has the size of the camera's picture;
/// `rows` as in trace_contours.
SilhouetteCounts extract_silhouette(const image::Mask& mask,
                                    const geometry::PinholeCamera& intrinsics,
                                    const SilhouetteOptions& options,
                                    SilhouetteScratch& scratch,
                                    std::vector<SilhouettePolygon>& out,
                                    std::span<const image::PixelSpan> rows = {});

/// Signed area: positive for counter-clockwise polygons, seen with +Y up.
double signed_area_px(const SilhouettePolygon& polygon);

}  // namespace atrium::silhouette
