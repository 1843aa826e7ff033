#pragma once

#include "tools/calibrate/recording/gather.hpp"

#include <string>

namespace atrium::calibrate {

/// Error kConfiguration if the masks of any camera have another size than its pictures: names all
/// these cameras, and the cure.
Expected<void> check_mask_sizes(const Material& material);

/// The hint for somebody who gives masks, but no pictures.
std::string why_masks_need_pictures(const Shots& masks);

}  // namespace atrium::calibrate
