#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace atrium::silhouette {

/// How far inside of the picture's border a field lies that the polygons of `extract_silhouette`
/// surely reach across: by `tolerance_px` they may miss the border, and lens distortion is taken
/// out of both up to 0.1 px. At least two pixels.
double field_inset_px(double tolerance_px);

/// What a camera sees for certain: its picture without a margin of `inset_px` [px of the delivered
/// picture], as a polygon in undistorted pixels, counter-clockwise seen with +Y up. Where the lens
/// bends the border, points lie so close that the polygon follows it up to 0.1 px.
///
/// Of a camera with an odd size the last column or row counts as outside: pictures have none
/// (image::YuvImage). nullopt where the lens model has no inverse along the border, or nothing is
/// left of the picture.
std::optional<std::vector<Eigen::Vector2d>> picture_field(const geometry::PinholeCamera& intrinsics,
                                                          double inset_px);

}  // namespace atrium::silhouette
