#pragma once

#include "core/base/expected.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <filesystem>
#include <string>

namespace atrium::segmentation {

/// Returns the file that keeps the background of one camera: `FOLDER/<camera>.background`. The
/// content does not depend on options: they may change without learning again.
///
/// Format, little-endian: "ATRIUMBG", version, camera name, size, mosaic, number of pictures, the
/// planes of BackgroundStatistics in declaration order, and a checksum of all this. The version is
/// 2 if `had_people`, else 1; older programs wrote 1 for both.
std::filesystem::path background_file(const std::filesystem::path& folder,
                                      const std::string& camera);

/// Writes or replaces the file atomically. Creates `folder` if needed.
Expected<void> save_background(const BackgroundStatistics& room,
                               const std::filesystem::path& folder,
                               const std::string& camera);

/// Errors name the file: kNotFound if it does not exist, kInvalidData if it is damaged, truncated,
/// of another version or of another camera.
Expected<BackgroundStatistics> load_background(const std::filesystem::path& folder,
                                               const std::string& camera);

}  // namespace atrium::segmentation
