#pragma once

#include "simulation/model.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::simulation {

/// Finds the picture that a model file names. The path may be one of another computer, with
/// backslashes or a drive. Searched are: the path as it is, the path from the model's folder, then
/// the file's name in any case in the model's folder, in `textures`, `tex`, `maps`, `images` and
/// `<model>.fbm` there and in the folder above; last, the name with another picture suffix. Empty:
/// not found.
std::optional<std::filesystem::path> find_picture(const std::string& path,
                                                  const std::filesystem::path& model);

/// Decodes a picture file: what OpenCV reads, and TGA. For untrusted bytes. Pictures beyond 4096
/// pixels are made smaller. Without pixels if it cannot be decoded.
ModelTexture decode_picture(std::span<const std::uint8_t> bytes);
ModelTexture read_picture(const std::filesystem::path& file);

/// The files beside a model that may be its pictures, materials or buffers.
std::vector<std::filesystem::path> companion_files(const std::filesystem::path& model);

}  // namespace atrium::simulation
