#pragma once

#include "site_node/silhouette/contours.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>

namespace atrium::silhouette {

/// Outline vertices lie on a grid of 1/1024 px: integers then decide exactly whether contour points
/// are near an edge.
constexpr int kUnitsPerPixel = 1024;

/// Returns the nearest grid place to `origin` + `offset_px`. If the mask, and with it `origin`,
/// shifts, so does the result.
Eigen::Vector2d snapped_px(GridPoint origin, const Eigen::Vector2d& offset_px);

/// Returns the tolerance in grid units, rounded down to 1/64 px like the thickness of blurred
/// segments.
std::int64_t tolerance_units(double tolerance_px);

/// Returns true if the contour points [begin, end], cyclic at contour.size(), all lie within
/// `tolerance` units (Euclidean) of the line segment from `a` to `b`, both on the grid. Exact; the
/// tolerance itself is accepted. Coordinates must be below 2^16 px, the tolerance below 2^8 px.
bool all_within(std::span<const GridPoint> contour,
                std::size_t begin,
                std::size_t end,
                const Eigen::Vector2d& a_px,
                const Eigen::Vector2d& b_px,
                std::int64_t tolerance);

}  // namespace atrium::silhouette
