#include "core/base/write_check.hpp"

#include "core/base/descriptor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

namespace atrium {
namespace {

std::string reason_of(int error) { return std::generic_category().message(error); }

std::string megabytes(std::uint64_t bytes) {
    return std::to_string((bytes + (1U << 20) - 1) >> 20) + " MiB";
}

}  // namespace

Expected<void> check_folder_writable(const std::filesystem::path& folder,
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
    if (access(existing.c_str(), W_OK | X_OK) != 0)
        return wrong("cannot write into " + existing.string() + ": " + reason_of(errno) +
                     "; make this folder writable, or give another one");
    const std::filesystem::space_info space = std::filesystem::space(existing, failure);
    if (!failure && space.available < bytes) {
        return wrong("the disk is full: needs " + megabytes(bytes) + ", has " +
                     std::to_string(space.available >> 20) + " MiB free");
    }
    return {};
}

Expected<void> probe_file(const std::filesystem::path& file) {
    const Descriptor probe(open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644));
    if (probe.get() < 0) return tl::unexpected(cannot_write(file, "create", errno));
    const std::array<char, 65536> zeros{};
    const ssize_t written = write(probe.get(), zeros.data(), zeros.size());
    const int error = written < 0 ? errno : ENOSPC;
    unlink(file.c_str());
    if (written != static_cast<ssize_t>(zeros.size()))
        return tl::unexpected(cannot_write(file, "write", error));
    return {};
}

Error cannot_write(const std::filesystem::path& file, const char* what, int error) {
    const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
    std::string cure;
    if (error == ENOENT || error == ENOTDIR) cure = "; create the folder " + folder;
    if (error == EACCES || error == EROFS) cure = "; make the folder " + folder + " writable";
    if (error == ENOSPC || error == EDQUOT) cure = "; free some space there";
    return {ErrorKind::kUnavailable,
            file.string() + ": cannot " + what + ": " + reason_of(error) + cure};
}

}  // namespace atrium
