#pragma once

#include "site_node/silhouette/contours.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>

namespace atrium::silhouette {

/// Vertices of outlines lie on a grid of 1/1024 px, so that whether contour points are near an edge
/// is decided by integers.
constexpr int kUnitsPerPixel = 1024;

/// The nearest place on that grid, seen from `origin`, which moves with the mask: so does the
/// result.
Eigen::Vector2d snapped_px(GridPoint origin, const Eigen::Vector2d& offset_px);

/// Rounded down to 1/64 px, as the thickness of blurred segments is.
std::int64_t tolerance_units(double tolerance_px);

/// Whether the contour points [begin, end], which are cyclic at contour.size(), all lie within
/// `tolerance` units (Euclidean) of the line segment from `a` to `b`, both on the grid. Exact; the
/// tolerance itself still belongs to it. Coordinates are below 2^16 px, the tolerance below 2^8 px.
bool all_within(std::span<const GridPoint> contour,
                std::size_t begin,
                std::size_t end,
                const Eigen::Vector2d& a_px,
                const Eigen::Vector2d& b_px,
                std::int64_t tolerance);

}  // namespace atrium::silhouette
