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

tl::unexpected<Error> wrong(ErrorKind kind,
                            const std::filesystem::path& path,
                            const std::string& why) {
    return make_error(kind, path.string() + ": " + why);
}

// The first folder on the way to the file that this process may not search; empty: none.
std::filesystem::path closed_folder_above(const std::filesystem::path& file) {
    std::filesystem::path folder;
    for (const std::filesystem::path& part : file.parent_path()) {
        folder /= part;
        if (access(folder.c_str(), X_OK) != 0) return folder;
    }
    return {};
}

// `error`: an errno of opening `path`; `missing` and `cure` if it is not there or has no
// permission.
tl::unexpected<Error> not_opened(const std::filesystem::path& path,
                                 int error,
                                 const char* missing,
                                 const char* cure) {
    if (error == ENOENT || error == ENOTDIR)
        return wrong(ErrorKind::kNotFound, path, missing + looked_up_from(path));
    const std::filesystem::path closed = closed_folder_above(path);
    if (error == EACCES && !closed.empty())
        return wrong(ErrorKind::kConfiguration,
                     path,
                     "this user may not look into the folder " + closed.string() +
                         "; run `chmod a+rx` on it");
    return wrong(
        ErrorKind::kConfiguration,
        path,
        std::string("cannot be read: ") + std::strerror(error) + (error == EACCES ? cure : ""));
}

}  // namespace

Expected<void> check_readable(const std::filesystem::path& file) {
    // a pipe without a writer must not block
    const Descriptor opened(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (opened.get() < 0)
        return not_opened(file, errno, "there is no such file", "; run `chmod a+r` on it");
    struct stat status {};
    if (fstat(opened.get(), &status) != 0 || !S_ISREG(status.st_mode))
        return wrong(ErrorKind::kConfiguration,
                     file,
                     S_ISDIR(status.st_mode) ? "is a folder, not a file" : "is not a regular file");
    return {};
}

Expected<void> check_folder_readable(const std::filesystem::path& folder) {
    constexpr const char* kCure = "; run `chmod a+rx` on it";
    const Descriptor opened(open(folder.c_str(), O_RDONLY | O_CLOEXEC | O_DIRECTORY));
    const int error = errno;
    std::error_code failure;
    if (opened.get() < 0 && std::filesystem::is_regular_file(folder, failure))
        return wrong(ErrorKind::kConfiguration, folder, "is a file, not a folder");
    if (opened.get() < 0) return not_opened(folder, error, "there is no such folder", kCure);
    if (access(folder.c_str(), X_OK) != 0)
        return not_opened(folder, errno, "there is no such folder", kCure);
    return {};
}

}  // namespace atrium
