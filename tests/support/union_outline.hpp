#pragma once

#include "tests/support/silhouette_maker.hpp"

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
    int num_segments = 100;  // of all outlines together, about; each has at least 4
    int num_cells = 160;     // of the raster, along the longer side of what is drawn
};

/// Outlines and holes of the union of convex polygons, cut by `picture`.
///
/// The union is drawn on a coarse raster, its outlines are traced there, and the points taken from
/// them are moved onto the polygon whose border is nearest: sub-pixel positions at the price of a
/// thumbnail. Details smaller than a cell are lost, and close to each other points may leave their
/// order, so that an outline can cross itself.
std::vector<Contour> outline_of_union(std::span<const Contour> shapes,
                                      const PixelBox& picture,
                                      const UnionOutlineOptions& options);

}  // namespace atrium::test
