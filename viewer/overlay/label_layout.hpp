#pragma once

#include "viewer/renderer/overlay.hpp"

#include <Eigen/Geometry>

#include <cstddef>
#include <vector>

namespace atrium::viewer {

/// Moves labels up until none covers another in the eye's picture. The first `num_kept` keep their
/// order of precedence and stay even where there is no room; of the others, the nearest come first,
/// and those without room are removed.
void separate_labels(std::vector<renderer::Label>& labels,
                     std::size_t num_kept,
                     const renderer::EyeView& eye);

/// Moves a label that reaches beyond the eye's picture until all of it is inside, if there is room
/// and the label is before the eye.
void keep_in_picture(renderer::Label& label, const renderer::EyeView& eye);

/// What the visible labels cover of the eye's picture, as shares of it, y downwards.
std::vector<Eigen::AlignedBox2f> label_boxes(const std::vector<renderer::Label>& labels,
                                             const renderer::EyeView& eye);

}  // namespace atrium::viewer
