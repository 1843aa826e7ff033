#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <filesystem>

namespace atrium::capture {

/// `FOLDER/%06d.png`, as recordings name their pictures.
std::filesystem::path numbered_png(const std::filesystem::path& folder, std::size_t number);

/// Writes what PictureFile::read_mask reads: an 8-bit PNG. Error kUnavailable where it cannot be
/// written.
Expected<void> write_mask(const image::Mask& mask, const std::filesystem::path& file);

}  // namespace atrium::capture
