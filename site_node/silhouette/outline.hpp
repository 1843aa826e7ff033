#pragma once

#include "site_node/silhouette/blurred_segments.hpp"
#include "site_node/silhouette/contours.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::silhouette {

/// A run of contour points that one polygon edge, its chord, stands for.
struct OutlineSegment {
    std::uint32_t begin =
        0;  // contour index; it ends where the next one begins (the last one at point 0)
    std::uint8_t level = 0;  // how often it was refined
    bool pinned = false;     // its first vertex is its first contour point
    bool unchecked = true;   // whether it keeps the tolerance is to be seen
};

/// One contour as a polygon in the delivered picture: `vertices_px[k]` is where segment k begins,
/// on the grid of chord_bound.hpp.
struct Outline {
    std::vector<OutlineSegment> segments;
    std::vector<Eigen::Vector2d> vertices_px;
};

/// The line of an edge that is not pinned.
struct EdgeLine {
    Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();  // from the segment's first contour point
    Eigen::Vector2d normal = Eigen::Vector2d::Zero();     // unit length, away from the foreground
    double bulge_px2 =
        0.0;  // area between the chord and the contour points, > 0 where they lie outside
};

struct OutlineScratch {
    BlurredSegment blurred;
    std::vector<std::uint32_t> breaks;
    std::vector<OutlineSegment> segments;
    std::vector<EdgeLine> lines;
    std::vector<Eigen::Vector2d> moves_px;  // of the vertices, from their contour points
    std::vector<std::uint8_t> marked;
};

/// Cuts `contour` into blurred segments of `tolerance_px` and places the vertices.
///
/// A chord of a convex arc lies inside the arc, so a polygon on contour points makes every body
/// thinner, and the greedy cut turns a little around each corner before it stops. Therefore each
/// edge lies on the least-squares line of its contour points, moved in parallel until it cuts off
/// as much area as it adds; vertices are where neighbouring lines meet.
///
/// Every contour point lies within `tolerance_px` (Euclidean, rounded down to 1/64 px) of the edge
/// of its own segment, the two ends of the segment included; that is decided by integers. Where an
/// edge would break that, its vertices are pinned to contour points, and where that does not help,
/// its segment is refined.
///
/// The outline moves with the mask bit for bit.
void fit_outline(std::span<const GridPoint> contour,
                 double tolerance_px,
                 OutlineScratch& scratch,
                 Outline& out);

/// Cuts the segments with `scratch.marked[k] != 0` at half their tolerance, pinned. The bound holds
/// again then. After a few calls a segment consists of its contour points.
void refine_outline(std::span<const GridPoint> contour,
                    double tolerance_px,
                    OutlineScratch& scratch,
                    Outline& outline);

/// Every contour point becomes a vertex: such outlines do not meet, as contours do not.
void use_contour_points(std::span<const GridPoint> contour, Outline& outline);

}  // namespace atrium::silhouette
