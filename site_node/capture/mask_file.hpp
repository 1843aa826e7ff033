#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <filesystem>

namespace atrium::capture {

/// Returns `FOLDER/%06d.png`, the picture name in recordings.
std::filesystem::path numbered_png(const std::filesystem::path& folder, std::size_t number);

/// Writes a mask as an 8-bit PNG that PictureFile::read_mask can read. Error kUnavailable.
Expected<void> write_mask(const image::Mask& mask, const std::filesystem::path& file);

/// True if people seem to be black: foreground covers most of the picture and nearly all of its
/// border. True as well for a camera right in front of somebody, so ask all cameras.
bool looks_inverted(const image::Mask& mask);

}  // namespace atrium::capture
