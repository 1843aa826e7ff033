#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace atrium::silhouette {

/// Returns an inset from the picture border that the polygons of `extract_silhouette` surely cross.
/// They may miss the border by `tolerance_px`, and the undistortion of both has an error of up to
/// 0.1 px. At least two pixels.
double field_inset_px(double tolerance_px);

/// Returns the certain field of view of a camera: its picture without a margin of `inset_px` [px of
/// the delivered picture], as a polygon in undistorted pixels, counter-clockwise with +Y up. Where
/// the lens bends the border, the polygon follows it within 0.1 px.
///
/// With an odd picture size, the last column or row counts as outside, since pictures lack it
/// (image::YuvImage). nullopt if the lens model has no inverse along the border, or nothing of the
/// picture remains.
std::optional<std::vector<Eigen::Vector2d>> picture_field(const geometry::PinholeCamera& intrinsics,
                                                          double inset_px);

}  // namespace atrium::silhouette
