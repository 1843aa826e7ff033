#include "core/model/material_file.hpp"

#include "core/model/model_file.hpp"

#include <fstream>
#include <string_view>
#include <system_error>

namespace atrium::model {

std::string missing_material_file(const std::filesystem::path& file) {
    constexpr std::string_view kKey = "mtllib";
    constexpr std::string_view kBlanks = " \t\r";
    constexpr std::size_t kMaxLines = 200'000;  // before the faces in usual files
    if (ending_of(file) != ".obj") return {};
    std::ifstream stream(file);
    std::string line;
    for (std::size_t i = 0; i < kMaxLines && std::getline(stream, line); ++i) {
        if (!line.starts_with(kKey) || line.find_first_of(kBlanks) != kKey.size()) continue;
        const std::size_t first = line.find_first_not_of(kBlanks, kKey.size());
        if (first == std::string::npos) continue;
        const std::string name = line.substr(first, line.find_last_not_of(kBlanks) + 1 - first);
        std::error_code failure;
        if (!std::filesystem::exists(file.parent_path() / name, failure)) return name;
    }
    return {};
}

}  // namespace atrium::model
