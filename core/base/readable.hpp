#pragma once

#include "core/base/expected.hpp"

#include <filesystem>

namespace atrium {

/// Error if `file` is not a regular file that this process may read. The message begins with the
/// path and tells the reason. kNotFound: it is not there; kConfiguration: anything else.
Expected<void> check_readable(const std::filesystem::path& file);

/// Error if `folder` is not a folder that this process may list and enter; as `check_readable`.
Expected<void> check_folder_readable(const std::filesystem::path& folder);

}  // namespace atrium
