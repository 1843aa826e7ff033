#pragma once

#include "core/image/image.hpp"
#include "core/image/sparse_mask.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::silhouette {

/// Point on the half-pixel grid: it stands for pixel position (x / 2, y / 2). Integers keep all
/// decisions on it exact.
struct GridPoint {
    std::int32_t x = 0;
    std::int32_t y = 0;
    bool operator==(const GridPoint&) const = default;
};

/// Closed outline of one blob or hole.
struct Contour {
    std::size_t begin = 0;  // first of its points in ContourSet::points
    std::size_t size = 0;
    std::int64_t area_px = 0;  // pixels enclosed, > 0 for blobs and < 0 for holes
    bool touches_border = false;
};

/// All outlines of one mask; reuse it, so that nothing is allocated in the long run.
struct ContourSet {
    std::vector<Contour> contours;
    std::vector<GridPoint> points;
    std::uint32_t num_small = 0;  // contours that enclose fewer than min_area_px pixels: left out

    std::vector<std::uint8_t>
        visited;  // scratch: stamp of the last call that walked over the crack above a pixel
    std::uint8_t stamp = 0;

    std::span<const GridPoint> points_of(const Contour& contour) const {
        return {points.data() + contour.begin, contour.size};
    }
};

/// Follows every border between foreground and background along the *cracks* between pixels and
/// notes the middle of each crack. Foreground lies left (seen with +Y up on the page). Outside the
/// picture is background.
///
/// Foreground is 4-connected, background 8-connected. As every crack belongs to one contour, and
/// contours that meet in a pixel corner cut that corner, no two contours and no two parts of one
/// contour touch: each is a simple polygon. The middle of a crack lies within half a pixel, in the
/// direction across the crack, of the true edge that the mask samples, with no bias to either side:
/// the enclosed area is `area_px` - 0.5 for blobs and + 0.5 (nearer to 0) for holes.
///
/// A contour starts in a vertex of its convex hull, so that the start does not wander: a blob in
/// the leftmost crack of its topmost row, a hole in the rightmost one of its lowest.
///
/// `rows`, if not empty, are the columns of each row outside of which `mask` is background.
void trace_contours(const image::Mask& mask,
                    std::int64_t min_area_px,
                    ContourSet& out,
                    std::span<const image::PixelSpan> rows = {});

/// Smallest rectangle of pixels that holds what the contours enclose; empty if there are none.
image::PixelRect bounding_rect(const ContourSet& contours);

}  // namespace atrium::silhouette
