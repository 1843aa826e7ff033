#pragma once

#include "tests/support/shapes/silhouette_maker.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace atrium::test {

/// A part of the picture plane [px].
struct PixelBox {
    Eigen::Vector2d min = Eigen::Vector2d::Constant(0.0);
    Eigen::Vector2d max = Eigen::Vector2d::Constant(0.0);
};

struct UnionOutlineOptions {
    int num_segments = 100;  // of all outlines together, approximately; each has at least 4
    int num_cells = 160;     // of the raster, along the longer side of the drawn area
};

/// Outlines and holes of the union of convex polygons, cut by `picture`.
///
/// Draws the union on a coarse raster, traces its outlines there, and moves the traced points onto
/// the nearest border of a polygon: sub-pixel positions at the price of a thumbnail. Details
/// smaller than a cell are lost. Points close to each other can lose their order, and an outline
/// can then cross itself.
std::vector<Contour> outline_of_union(std::span<const Contour> shapes,
                                      const PixelBox& picture,
                                      const UnionOutlineOptions& options);

}  // namespace atrium::test
