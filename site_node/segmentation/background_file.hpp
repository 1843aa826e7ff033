#pragma once

#include "core/base/expected.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <filesystem>
#include <string>

namespace atrium::segmentation {

/// Keeps what was learned of the empty room: one file per camera, `FOLDER/<camera>.background`.
/// Options have no part in it, so that they can be changed without learning anew.
///
/// Little-endian: "ATRIUMBG", version, camera's name, size, mosaic, number of pictures, the planes
/// of BackgroundStatistics in the order of their declaration, and a checksum of all that.
std::filesystem::path background_file(const std::filesystem::path& folder,
                                      const std::string& camera);

/// Makes `folder` if it is not there. The file appears whole or not at all; one that is there is
/// replaced.
Expected<void> save_background(const BackgroundStatistics& room,
                               const std::filesystem::path& folder,
                               const std::string& camera);

/// Errors name the file: kNotFound where there is none, kInvalidData where it is damaged, cut
/// short, of another version, or of another camera.
Expected<BackgroundStatistics> load_background(const std::filesystem::path& folder,
                                               const std::string& camera);

}  // namespace atrium::segmentation
