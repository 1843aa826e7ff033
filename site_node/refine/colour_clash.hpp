#pragma once

#include "site_node/refine/luma_picture.hpp"

#include <Eigen/Core>

#include <optional>
#include <span>

namespace atrium::refine {

/// Luma and chroma of 3 x 3 blocks around a place of the picture that `luma` was filled from: the
/// mean of those inside the mask [grey levels]. Nullopt at the border of the picture, and where
/// less than three are inside.
std::optional<Eigen::Vector3f> colour_at(const PictureView& view,
                                         const LumaPicture& luma,
                                         const Eigen::Vector2f& place);

/// The largest difference between two of the colours [grey levels]. Luma counts less, because it
/// depends on the direction to the light and on the camera. 0 for less than two.
float colour_clash(std::span<const Eigen::Vector3f> colours);

}  // namespace atrium::refine
