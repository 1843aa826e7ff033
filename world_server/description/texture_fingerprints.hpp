#pragma once

#include "core/base/fingerprint.hpp"
#include "world_server/description/world_description.hpp"

#include <filesystem>
#include <string>

namespace atrium::world_server {

/// The fingerprint of a texture in the folder of models; unknown without a name or a folder, and if
/// viewers could not read the file either.
Fingerprint texture_fingerprint(const std::filesystem::path& folder, const std::string& texture);

/// Reads the textures that a world names, each once, for the fingerprints in its looks.
void fingerprint_textures(WorldDescription& description);

}  // namespace atrium::world_server
