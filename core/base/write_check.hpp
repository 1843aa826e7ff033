#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <filesystem>

/// Checks at the start, before slow work, that results can be written.
namespace atrium {

/// Checks that files can be written into `folder`, which need not exist yet: its nearest existing
/// parent must be a folder that this user may write, with `bytes` of free space. Changes nothing.
/// The error (kUnavailable) names the folder, what is missing and `what` needs it.
Expected<void> check_folder_writable(const std::filesystem::path& folder,
                                     std::uint64_t bytes,
                                     const char* what);

/// Tests whether a file can be written: creates `file`, writes 64 KiB and removes it. Give the name
/// of a temporary file beside the real one. Fails with kUnavailable as `cannot_write`.
Expected<void> probe_file(const std::filesystem::path& file);

/// "FILE: cannot WHAT: the system's reason; what to do". `error`: an errno of opening or writing
/// `file`.
Error cannot_write(const std::filesystem::path& file, const char* what, int error);

}  // namespace atrium
