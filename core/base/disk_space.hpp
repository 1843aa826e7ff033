#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <filesystem>

namespace atrium {

/// Checks, before slow work, that files can be written into `folder`, which need not exist yet: its
/// nearest existing parent must be a folder that this user may write, with `bytes` of free space.
/// Changes nothing. The error (kUnavailable) names the folder, what is missing and `what` needs it.
Expected<void> check_writable(const std::filesystem::path& folder,
                              std::uint64_t bytes,
                              const char* what);

}  // namespace atrium
