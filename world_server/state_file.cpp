#include "world_server/state_file.hpp"

#include "core/base/descriptor.hpp"
#include "core/base/write_check.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace atrium::world_server {
namespace {

namespace fs = std::filesystem;
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{64} << 20U;  // 2048 objects need 0.5 MB
constexpr int kMaxKept = 1000;

Error failed(const char* what, const fs::path& file, int number) {
    return {ErrorKind::kUnavailable,
            fmt::format("{}: cannot {}: {}", file.string(), what, std::strerror(number))};
}

Expected<void> write_all(const Descriptor& out,
                         std::span<const std::uint8_t> bytes,
                         const fs::path& file) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(out.get(), bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return tl::unexpected(failed("write", file, errno));
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    if (::fsync(out.get()) != 0) return tl::unexpected(failed("write", file, errno));
    return {};
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

Expected<void> write_atomically(const fs::path& file, std::span<const std::uint8_t> bytes) {
    const fs::path temporary = file.string() + ".new";
    {
        const Descriptor out(
            ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
        if (out.get() < 0) return tl::unexpected(failed("create", temporary, errno));
        if (auto written = write_all(out, bytes, temporary); !written) {
            ::unlink(temporary.c_str());
            return written;
        }
    }
    if (::rename(temporary.c_str(), file.c_str()) != 0) {
        return tl::unexpected(failed("replace", file, errno));
    }
    // the new name is durable only when its folder is written
    const Descriptor folder(::open(folder_of(file).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (folder.get() < 0 || ::fsync(folder.get()) != 0) {
        return tl::unexpected(failed("write the folder of", file, errno));
    }
    return {};
}

Expected<void> check_writable(const fs::path& file) {
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) return tl::unexpected(failed("replace", file, EISDIR));
    return probe_file(file.string() + ".new");
}

Expected<std::vector<std::uint8_t>> read_file(const fs::path& file) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (error == std::errc::no_such_file_or_directory) {
        return make_error(ErrorKind::kNotFound, file.string() + ": does not exist");
    }
    if (error) return tl::unexpected(failed("read", file, error.value()));
    if (size > kMaxBytes) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("{}: {} bytes is larger than any state", file.string(), size));
    }
    std::vector<std::uint8_t> bytes(size);
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!in) return tl::unexpected(failed("read", file, EIO));
    return bytes;
}

Expected<fs::path> put_aside(const fs::path& file) {
    for (int number = 1; number <= kMaxKept; ++number) {
        const fs::path aside = fmt::format("{}.bad-{}", file.string(), number);
        // a link fails if the name is taken; a rename does not
        if (::link(file.c_str(), aside.c_str()) == 0) {
            if (::unlink(file.c_str()) != 0) return tl::unexpected(failed("rename", file, errno));
            return aside;
        }
        if (errno != EEXIST) return tl::unexpected(failed("rename", file, errno));
    }
    return make_error(
        ErrorKind::kUnavailable,
        fmt::format("{}: {} damaged files are already kept, delete some", file.string(), kMaxKept));
}

}  // namespace atrium::world_server
