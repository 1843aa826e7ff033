#include "core/base/disk_space.hpp"

#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace atrium {
namespace {

std::string megabytes(std::uint64_t bytes) {
    return std::to_string((bytes + (1U << 20) - 1) >> 20) + " MiB";
}

}  // namespace

Expected<void> check_writable(const std::filesystem::path& folder,
                              std::uint64_t bytes,
                              const char* what) {
    std::error_code failure;
    std::filesystem::path existing = std::filesystem::absolute(folder, failure);
    while (!std::filesystem::exists(existing, failure) && existing.has_relative_path())
        existing = existing.parent_path();
    const auto wrong = [&](const std::string& text) {
        return make_error(ErrorKind::kUnavailable,
                          std::string(what) + ": " + folder.string() + ": " + text);
    };
    if (!std::filesystem::is_directory(existing, failure))
        return wrong(existing.string() + " is not a folder");
    if (access(existing.c_str(), W_OK | X_OK) != 0) {
        const std::error_code reason(errno, std::generic_category());
        return wrong("cannot write into " + existing.string() + ": " + reason.message());
    }
    const std::filesystem::space_info space = std::filesystem::space(existing, failure);
    if (!failure && space.available < bytes) {
        return wrong("the disk is full: needs " + megabytes(bytes) + ", has " +
                     std::to_string(space.available >> 20) + " MiB free");
    }
    return {};
}

}  // namespace atrium
