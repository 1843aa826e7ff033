#pragma once

#include "core/image/image.hpp"
#include "core/image/sparse_mask.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::silhouette {

/// Point on the half-pixel grid, at pixel position (x / 2, y / 2). Integers keep all decisions
/// exact.
struct GridPoint {
    std::int32_t x = 0;
    std::int32_t y = 0;
    bool operator==(const GridPoint&) const = default;
};

/// Closed outline of one blob or hole.
struct Contour {
    std::size_t begin = 0;  // its first point in ContourSet::points
    std::size_t size = 0;
    std::int64_t area_px = 0;  // pixels enclosed, > 0 for blobs and < 0 for holes
    bool touches_border = false;
};

/// All outlines of one mask. Reusable: it stops allocating after a few masks.
struct ContourSet {
    std::vector<Contour> contours;
    std::vector<GridPoint> points;
    std::uint32_t num_small = 0;  // skipped: contours that enclose fewer than min_area_px pixels

    // scratch: stamp of the last call that followed the crack above a pixel
    std::vector<std::uint8_t> visited;
    std::uint8_t stamp = 0;

    std::span<const GridPoint> points_of(const Contour& contour) const {
        return {points.data() + contour.begin, contour.size};
    }
};

/// Follows every border between foreground and background along the *cracks* between pixels and
/// records the middle of each crack. Foreground lies on the left (with +Y up). Pixels outside the
/// picture are background.
///
/// Foreground is 4-connected, background 8-connected. Every crack belongs to one contour, and
/// contours that meet in a pixel corner cut that corner. Therefore no two contours and no two parts
/// of a contour touch: each is a simple polygon. The middle of a crack lies within half a pixel,
/// measured across the crack, of the true edge that the mask samples, without bias: the enclosed
/// area is `area_px` - 0.5 for blobs and + 0.5 (nearer to 0) for holes.
///
/// A contour starts at a vertex of its convex hull, which keeps the start stable: a blob at the
/// leftmost crack of its topmost row, a hole at the rightmost crack of its lowest.
///
/// `rows`, if not empty, gives the columns of each row outside of which `mask` is background.
void trace_contours(const image::Mask& mask,
                    std::int64_t min_area_px,
                    ContourSet& out,
                    std::span<const image::PixelSpan> rows = {});

/// Returns the smallest rectangle of pixels that holds everything the contours enclose; empty
/// without contours.
image::PixelRect bounding_rect(const ContourSet& contours);

}  // namespace atrium::silhouette
