#pragma once

#include <filesystem>
#include <string>

namespace atrium::model {

/// Why a glTF file cannot be read as its author means: it requires an extension that moves, packs
/// or repeats its geometry and that Assimp passes over, with the cure. Empty: it requires none,
/// or it is no glTF 2. The bytes may be hostile. Private to core/model.
std::string unread_extension(const std::filesystem::path& file);

}  // namespace atrium::model
