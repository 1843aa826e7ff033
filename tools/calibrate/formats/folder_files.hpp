#pragma once

#include "core/base/expected.hpp"

#include <filesystem>
#include <string>
#include <vector>

/// Folders of calibration files. `with_folders_opened` is in format.hpp.
namespace atrium::calibrate {

/// ".toml" of a file's name, in lower case.
std::string suffix_of(const std::filesystem::path& file);

/// Error kConfiguration: `files` are several of `what`, such as "models of COLMAP", of which the
/// user has to choose one; `cure` says which.
tl::unexpected<Error> several_of(const std::vector<std::filesystem::path>& files,
                                 const std::string& what,
                                 const std::string& cure);

}  // namespace atrium::calibrate
