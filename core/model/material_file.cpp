#include "core/model/material_file.hpp"

#include "core/model/model_file.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string_view>
#include <system_error>

namespace atrium::model {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
    std::ranges::transform(
        text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

// The first of that name, whatever the order of the folder; empty: none.
fs::path find_in(const fs::path& folder, const std::string& name) {
    constexpr int kMaxFiles = 10'000;
    fs::path found;
    std::error_code failure;
    int num_files = 0;
    for (fs::directory_iterator it(folder, failure), end; !failure && it != end;
         it.increment(failure)) {
        if (++num_files > kMaxFiles) break;
        if (lower(it->path().filename().string()) != lower(name)) continue;
        std::error_code unknown;
        if (it->is_regular_file(unknown) && (found.empty() || it->path() < found))
            found = it->path();
    }
    return found;
}

}  // namespace

std::string last_name_of(const std::string& path) {
    const std::size_t cut = path.find_last_of("/\\");
    return cut == std::string::npos ? path : path.substr(cut + 1);
}

fs::path file_beside(const fs::path& model, const std::string& written) {
    const fs::path folder = model.has_parent_path() ? model.parent_path() : fs::path(".");
    std::error_code failure;
    if (fs::path(written).is_relative() && fs::is_regular_file(folder / written, failure))
        return folder / written;
    const std::string name = last_name_of(written);
    if (name.empty()) return {};
    const fs::path found = find_in(folder, name);
    if (!found.empty() || ending_of(name) != ".mtl") return found;
    return find_in(folder, model.stem().string() + ".mtl");
}

std::string missing_material_file(const fs::path& file) {
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
        if (file_beside(file, name).empty()) return name;
    }
    return {};
}

}  // namespace atrium::model
