#pragma once

#include "site_node/silhouette/blurred_segments.hpp"
#include "site_node/silhouette/contours.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::silhouette {

/// A run of contour points that one polygon edge, its chord, replaces.
struct OutlineSegment {
    std::uint32_t begin = 0;  // contour index; ends at the next segment (the last at point 0)
    std::uint8_t level = 0;   // number of refinements
    bool pinned = false;      // its first vertex is its first contour point
    bool unchecked = true;    // the tolerance is not verified yet
};

/// One contour as a polygon in the delivered picture. Segment k begins at `vertices_px[k]`, on the
/// grid of chord_bound.hpp.
struct Outline {
    std::vector<OutlineSegment> segments;
    std::vector<Eigen::Vector2d> vertices_px;
};

/// Line of an edge that is not pinned.
struct EdgeLine {
    Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();  // from the segment's first contour point
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();     // unit length, away from the foreground
    // area between the chord and the contour points, > 0 if they lie outside
    double bulge_px2 = 0.0;
};

struct OutlineScratch {
    BlurredSegment blurred;
    std::vector<std::uint32_t> breaks;
    std::vector<OutlineSegment> segments;
    std::vector<EdgeLine> lines;
    std::vector<Eigen::Vector2d> moves_px;  // of the vertices, from their contour points
    std::vector<std::uint8_t> marked;
};

/// Splits `contour` into blurred segments of `tolerance_px` and places the vertices.
///
/// A chord of a convex arc lies inside the arc: a polygon on contour points makes every body
/// thinner, and the greedy split runs a little past each corner. Therefore each edge lies on the
/// least-squares line of its contour points, shifted in parallel until it cuts off as much area as
/// it adds. Vertices are the intersections of neighbouring lines.
///
/// Every contour point, including both ends of a segment, lies within `tolerance_px` (Euclidean,
/// rounded down to 1/64 px) of the edge of its segment; integers decide this. If an edge violates
/// it, its vertices are pinned to contour points; if that is not enough, its segment is refined.
///
/// If the mask shifts, the outline shifts by the same amount, bit for bit.
void fit_outline(std::span<const GridPoint> contour,
                 double tolerance_px,
                 OutlineScratch& scratch,
                 Outline& out);

/// Splits the segments with `scratch.marked[k] != 0` at half their tolerance, with pinned ends. The
/// bound holds again afterwards. After a few calls a segment consists of its contour points.
void refine_outline(std::span<const GridPoint> contour,
                    double tolerance_px,
                    OutlineScratch& scratch,
                    Outline& outline);

/// Makes every contour point a vertex. These outlines never meet, since contours do not.
void use_contour_points(std::span<const GridPoint> contour, Outline& outline);

}  // namespace atrium::silhouette
