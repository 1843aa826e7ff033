#include "core/base/readable.hpp"

#include "core/base/descriptor.hpp"
#include "core/base/looked_up.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace atrium {
namespace {

// The first folder on the way to the file that this process may not search; empty: none.
std::filesystem::path closed_folder_above(const std::filesystem::path& file) {
    std::filesystem::path folder;
    for (const std::filesystem::path& part : file.parent_path()) {
        folder /= part;
        if (access(folder.c_str(), X_OK) != 0) return folder;
    }
    return {};
}

}  // namespace

Expected<void> check_readable(const std::filesystem::path& file) {
    const auto wrong = [&](ErrorKind kind, const std::string& why) {
        return make_error(kind, file.string() + ": " + why);
    };
    // a pipe without a writer must not block
    const Descriptor opened(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (opened.get() < 0) {
        const int error = errno;
        if (error == ENOENT || error == ENOTDIR)
            return wrong(ErrorKind::kNotFound, "there is no such file" + looked_up_from(file));
        const std::filesystem::path closed = closed_folder_above(file);
        if (error == EACCES && !closed.empty())
            return wrong(ErrorKind::kConfiguration,
                         "this user may not look into the folder " + closed.string() +
                             "; run `chmod a+rx` on it");
        return wrong(ErrorKind::kConfiguration,
                     std::string("cannot be read: ") + std::strerror(error) +
                         (error == EACCES ? "; run `chmod a+r` on it" : ""));
    }
    struct stat status {};
    if (fstat(opened.get(), &status) != 0 || !S_ISREG(status.st_mode))
        return wrong(ErrorKind::kConfiguration,
                     S_ISDIR(status.st_mode) ? "is a folder, not a file" : "is not a regular file");
    return {};
}

}  // namespace atrium
