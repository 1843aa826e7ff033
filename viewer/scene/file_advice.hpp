#pragma once

#include "core/base/expected.hpp"

#include <filesystem>
#include <string>

namespace atrium::viewer {

/// Says what to do about a file of a world that cannot be read from `folder`, the viewer's folder
/// of models: which folder to give if the file is not there, else `mend`, which mends the file.
std::string advice_about(const Error& failure,
                         const std::filesystem::path& folder,
                         const std::string& file,
                         const std::string& mend);

}  // namespace atrium::viewer
