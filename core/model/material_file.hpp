#pragma once

#include <filesystem>
#include <string>

namespace atrium::model {

/// The last name of a path of any computer, with slashes or backslashes.
std::string last_name_of(const std::string& path);

/// The file that a model names, as it lies beside the model: at the path from its folder, else the
/// file of the same name in any case, whatever folder of whatever computer the path names; else,
/// for materials (.mtl), the one that is named like the model. Empty: there is none.
std::filesystem::path file_beside(const std::filesystem::path& model, const std::string& written);

/// The first file of materials that an OBJ file names (`mtllib`) and that is not there
/// (`file_beside`), as the file writes it; else empty, also for other formats. Without it, the
/// parts have no colours.
std::string missing_material_file(const std::filesystem::path& file);

}  // namespace atrium::model
