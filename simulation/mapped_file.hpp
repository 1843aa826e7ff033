#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace atrium::simulation {

/// A whole file, mapped for reading. Programs that map the same file share its memory.
///
/// A file that shrinks under a mapping kills the process that reads there (SIGBUS). Therefore the
/// mapping holds a read lease (fcntl, F_SETLEASE): whoever wants to write to the file, or to cut it
/// short, waits in `open` or `truncate` until the lease is given up, for 45 s by default
/// (/proc/sys/fs/lease-break-time). Poll `is_wanted` more often than that, and let the mapping go
/// when it is true. Replacing the file by `rename`, and removing it, disturb nobody.
class MappedFile {
public:
    /// Error kNotFound if there is no such file, kUnavailable if it cannot be mapped under a lease:
    /// somebody has it open for writing, it belongs to somebody else, or the file system has no
    /// leases.
    static Expected<std::shared_ptr<const MappedFile>> open(const std::filesystem::path& path);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::span<const std::uint8_t> bytes() const { return bytes_; }

    /// Somebody waits for permission to change the file.
    bool is_wanted() const;

private:
    MappedFile() = default;
    Descriptor file_{-1};
    std::span<const std::uint8_t> bytes_;
};

}  // namespace atrium::simulation
