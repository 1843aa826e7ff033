#pragma once

#include <filesystem>
#include <string>

namespace atrium {

/// For messages that a path does not exist: " (looked up from /home/me)" for a relative path, which
/// is relative to the current folder; nothing for an absolute one.
inline std::string looked_up_from(const std::filesystem::path& path) {
    if (path.is_absolute()) return {};
    std::error_code failure;
    const std::filesystem::path folder = std::filesystem::current_path(failure);
    return failure ? std::string() : " (looked up from " + folder.string() + ")";
}

}  // namespace atrium
