#pragma once

#include <sys/types.h>
#include <sys/uio.h>

#include <cstdint>
#include <filesystem>
#include <functional>

namespace atrium::record {

/// What a recording asks of the system. Tests give others: a slow or a full disk.
struct FileCalls {
    /// writev(2) of pictures.
    std::function<ssize_t(int file, const iovec* parts, int num_parts)> write;
    /// Bytes that this user may still write into `folder`; the largest number if unknown.
    std::function<std::uint64_t(const std::filesystem::path& folder)> free_bytes;
};

/// The system's own.
FileCalls system_calls();

}  // namespace atrium::record
