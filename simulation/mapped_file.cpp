#include "simulation/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>

namespace atrium::simulation {

Expected<std::shared_ptr<const MappedFile>> MappedFile::open(const std::filesystem::path& path) {
    const auto failed = [&](const char* what) {
        const int code = errno;
        return make_error(code == ENOENT ? ErrorKind::kNotFound : ErrorKind::kUnavailable,
                          path.string() + ": " + what + ": " + std::strerror(code));
    };
    std::shared_ptr<MappedFile> mapped(new MappedFile);
    mapped->file_ = Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    const int file = mapped->file_.get();
    if (file < 0) return failed("open");
    // The kernel announces a waiting process by a signal. The default, SIGIO, would end this
    // process; SIGURG is ignored by default, and `is_wanted` polls instead.
    if (::fcntl(file, F_SETSIG, SIGURG) != 0) return failed("F_SETSIG");
    if (::fcntl(file, F_SETLEASE, F_RDLCK) != 0) return failed("F_SETLEASE");
    // from here on the size cannot change
    struct stat status {};
    if (::fstat(file, &status) != 0) return failed("fstat");
    if (!S_ISREG(status.st_mode) || status.st_size == 0) {
        errno = EINVAL;
        return failed("not a file with content");
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_POPULATE, file, 0);
    if (memory == MAP_FAILED) return failed("mmap");
    mapped->bytes_ = {static_cast<const std::uint8_t*>(memory), size};
    return std::shared_ptr<const MappedFile>(std::move(mapped));
}

MappedFile::~MappedFile() {
    if (!bytes_.empty())
        ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());  // before the lease ends
}

bool MappedFile::is_wanted() const { return ::fcntl(file_.get(), F_GETLEASE) != F_RDLCK; }

}  // namespace atrium::simulation
