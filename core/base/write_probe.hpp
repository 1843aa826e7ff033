#pragma once

#include "core/base/expected.hpp"

#include <filesystem>

namespace atrium {

/// Tests whether a file can be written: creates `file`, writes 64 KiB and removes it. Give the name
/// of a temporary file beside the real one. Fails with kUnavailable, the system's reason and what
/// to do.
Expected<void> probe_writing(const std::filesystem::path& file);

}  // namespace atrium
