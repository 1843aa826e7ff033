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
/// If a mapped file shrinks, the process that reads beyond the new end dies (SIGBUS). Therefore the
/// mapping holds a read lease (fcntl, F_SETLEASE): `open` for writing and `truncate` block until
/// the lease ends, for 45 s by default (/proc/sys/fs/lease-break-time). Poll `is_wanted` more often
/// than that, and release the mapping when it is true. A `rename` over the file and its removal are
/// harmless.
class MappedFile {
public:
    /// Error kNotFound if the file does not exist, kUnavailable if it cannot be mapped under a
    /// lease: it is open for writing, belongs to another user, or its file system has no leases.
    static Expected<std::shared_ptr<const MappedFile>> open(const std::filesystem::path& path);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::span<const std::uint8_t> bytes() const { return bytes_; }

    /// Returns true if a process waits to change the file.
    bool is_wanted() const;

private:
    MappedFile() = default;
    Descriptor file_{-1};
    std::span<const std::uint8_t> bytes_;
};

}  // namespace atrium::simulation
