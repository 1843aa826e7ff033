#include "core/keys/private_file.hpp"

#include "core/base/descriptor.hpp"
#include "core/base/looked_up.hpp"
#include "core/base/write_check.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace atrium::keys {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kOwnerOnly = 0600;

// systemd gives a service its credentials by an access control list, which shows as mode 0440.
bool is_private(const struct stat& info) {
    const mode_t mode = info.st_mode & 07777U;
    if ((mode & 077U) == 0) return true;
    return mode == 0440 && info.st_uid == 0 && info.st_gid == 0;
}

Expected<void> write_whole(const Descriptor& out, const std::string& text, const fs::path& file) {
    std::size_t done = 0;
    while (done < text.size()) {
        const ssize_t written = ::write(out.get(), text.data() + done, text.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return tl::unexpected(cannot_write(file, "write", errno));
        done += static_cast<std::size_t>(written);
    }
    if (::fsync(out.get()) != 0) return tl::unexpected(cannot_write(file, "write", errno));
    return {};
}

bool rename_without_replacing(const fs::path& from, const fs::path& to) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0)
        return true;
    if (errno != EINVAL && errno != ENOSYS) return false;
    // a file system that cannot do both at once
    struct stat info {};
    if (::lstat(to.c_str(), &info) == 0) {
        errno = EEXIST;
        return false;
    }
    return ::rename(from.c_str(), to.c_str()) == 0;
}

}  // namespace

Expected<std::string> read_private_file(const fs::path& file,
                                        std::size_t max_bytes,
                                        bool (*is_ours)(const std::string& text)) {
    const auto unreadable = [&](int error) {
        return make_error(ErrorKind::kNotFound,
                          file.string() + ": cannot be read: " + std::strerror(error) +
                              (error == ENOENT ? looked_up_from(file) : std::string()));
    };
    const auto refused = [&](const std::string& why) {
        return make_error(ErrorKind::kConfiguration, file.string() + ": " + why);
    };
    // not blocking: a pipe would wait for a writer
    const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (opened.get() < 0) return unreadable(errno);
    struct stat info {};
    if (::fstat(opened.get(), &info) != 0) return unreadable(errno);
    if (!S_ISREG(info.st_mode)) return refused("is not a file; give the path of a file with keys");
    const auto open_to_others = [&] {
        return refused(
            fmt::format("others can read the private key in it (mode {:04o}); run "
                        "`chmod 600 '{}'`, and renew the key if somebody may have read "
                        "it",
                        info.st_mode & 07777U,
                        file.string()));
    };
    const bool is_open = !is_private(info);
    if (is_open && is_ours == nullptr) return open_to_others();
    std::string text;
    std::array<char, 16384> part;
    for (;;) {
        const ssize_t num_bytes = ::read(opened.get(), part.data(), part.size());
        if (num_bytes < 0 && errno == EINTR) continue;
        if (num_bytes < 0) return unreadable(errno);
        if (num_bytes == 0) {
            if (is_open && is_ours(text)) return open_to_others();
            return text;
        }
        text.append(part.data(), static_cast<std::size_t>(num_bytes));
        if (text.size() > max_bytes)
            return refused(
                fmt::format("is larger than {} KiB, the limit for keys; is it the right "
                            "file?",
                            max_bytes >> 10U));
    }
}

Expected<void> write_private_file(const fs::path& file,
                                  const std::string& text,
                                  Existing existing) {
    const fs::path temporary = fmt::format("{}.{}.new", file.string(), ::getpid());
    {
        // one that a killed process of the same number left has perhaps other rights
        ::unlink(temporary.c_str());
        const Descriptor out(
            ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kOwnerOnly));
        if (out.get() < 0) return tl::unexpected(cannot_write(file, "create", errno));
        if (auto written = write_whole(out, text, file); !written) {
            ::unlink(temporary.c_str());
            return written;
        }
    }
    const bool is_renamed = existing == Existing::kReplace
                                ? ::rename(temporary.c_str(), file.c_str()) == 0
                                : rename_without_replacing(temporary, file);
    if (!is_renamed) {
        const int error = errno;
        ::unlink(temporary.c_str());
        if (error == EEXIST)
            return make_error(
                ErrorKind::kConfiguration,
                file.string() + ": exists already; give another name, or add --replace");
        return tl::unexpected(cannot_write(file, "write", error));
    }
    // the new name is durable only when its folder is written
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (opened.get() < 0 || ::fsync(opened.get()) != 0)
        return tl::unexpected(cannot_write(file, "write", errno));
    return {};
}

}  // namespace atrium::keys
