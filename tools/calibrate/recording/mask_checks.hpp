#pragma once

#include "tools/calibrate/recording/gather.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Error kConfiguration if the masks of any camera have another size than its pictures: names all
/// these cameras, and the cure.
Expected<void> check_mask_sizes(const Material& material);

/// The same of pictures of the empty room.
Expected<void> check_background_sizes(const Material& material);

/// Up to `most` masks of each camera, spread over all.
std::vector<std::filesystem::path> some_masks(const Material& material, std::size_t most);

/// Error kConfiguration if the first masks of all cameras look inverted, or if a first mask is a
/// picture in colours; with the cure. After their values are read as `mask_reading` says.
Expected<void> check_mask_values(const Material& material);

/// What to do if no mask shows anybody, of six per camera; empty if one does.
std::string doubt_of_empty_masks(const Material& material);

/// The hint for somebody who gives masks, but no pictures.
std::string why_masks_need_pictures(const Shots& masks);

}  // namespace atrium::calibrate
