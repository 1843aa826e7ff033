#include "core/base/write_probe.hpp"

#include "core/base/descriptor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

namespace atrium {
namespace {

tl::unexpected<Error> cannot(const std::string& what,
                             const std::filesystem::path& file,
                             int error) {
    const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
    std::string cure;
    if (error == ENOENT || error == ENOTDIR) cure = "; create the folder " + folder;
    if (error == EACCES || error == EROFS) cure = "; make the folder " + folder + " writable";
    if (error == ENOSPC || error == EDQUOT) cure = "; free some space there";
    return make_error(ErrorKind::kUnavailable,
                      file.string() + ": cannot " + what + ": " + std::strerror(error) + cure);
}

}  // namespace

Expected<void> probe_writing(const std::filesystem::path& file) {
    const Descriptor probe(open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644));
    if (probe.get() < 0) return cannot("create", file, errno);
    const std::array<char, 65536> zeros{};
    const ssize_t written = write(probe.get(), zeros.data(), zeros.size());
    const int error = written < 0 ? errno : ENOSPC;
    unlink(file.c_str());
    if (written != static_cast<ssize_t>(zeros.size())) return cannot("write", file, error);
    return {};
}

}  // namespace atrium
