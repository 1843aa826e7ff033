#include "tools/calibrate/formats/rig_file.hpp"

#include "core/base/write_check.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>

namespace atrium::calibrate {

bool is_rig(const Tree& toml) {
    const Tree* cameras = find(toml, {"camera"});
    return cameras != nullptr && cameras->is_array();
}

bool is_rig_file(const std::filesystem::path& file) {
    if (file.extension() != ".toml") return false;
    const auto text = read_bytes(file, kMaxTextBytes);
    const auto tree = text ? parse_toml(*text, file.string()) : Expected<Tree>(Tree());
    return tree && is_rig(*tree);
}

Expected<void> write_text(const std::filesystem::path& file,
                          const std::string& text,
                          bool may_replace) {
    std::error_code failure;
    if (!may_replace && std::filesystem::exists(file, failure)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: exists already; give another -o, or --force to replace "
                                      "it",
                                      file.string()));
    }
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (!std::filesystem::exists(file, failure)) {
        if (auto writable = check_folder_writable(folder, text.size(), "-o"); !writable)
            return writable;
    }
    std::filesystem::create_directories(folder, failure);
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream << text;
    stream.close();
    if (stream) return {};
    return tl::unexpected(cannot_write(file, "write", errno));
}

}  // namespace atrium::calibrate
