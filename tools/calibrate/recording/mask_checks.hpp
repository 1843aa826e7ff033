#pragma once

#include "core/image/image.hpp"
#include "tools/calibrate/recording/gather.hpp"

#include <string>

namespace atrium::calibrate {

/// Error kConfiguration if the masks of any camera have another size than its pictures: names all
/// these cameras, and the cure.
Expected<void> check_mask_sizes(const Material& material);

/// The same of pictures of the empty room.
Expected<void> check_background_sizes(const Material& material);

/// The mask in a file; `inverted`: people are black there. Errors of capture::PictureFile.
Expected<image::Mask> read_mask(const std::filesystem::path& file, bool inverted);

/// Error kConfiguration if the first masks of all cameras look inverted, or if a first mask is a
/// picture in colours; with the cure. `inverted`: after their values are inverted.
Expected<void> check_mask_values(const Material& material, bool inverted);

/// What to do if no mask shows anybody, of six per camera; empty if one does.
std::string doubt_of_empty_masks(const Material& material, bool inverted);

/// The hint for somebody who gives masks, but no pictures.
std::string why_masks_need_pictures(const Shots& masks);

}  // namespace atrium::calibrate
