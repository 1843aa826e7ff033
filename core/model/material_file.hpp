#pragma once

#include <filesystem>
#include <string>

namespace atrium::model {

/// The first file of materials that an OBJ file names (`mtllib`) and that is not there, as the file
/// writes it; else empty, also for other formats. Without it, the parts have no colours.
std::string missing_material_file(const std::filesystem::path& file);

}  // namespace atrium::model
