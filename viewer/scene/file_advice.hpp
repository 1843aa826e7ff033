#pragma once

#include "core/base/expected.hpp"

#include <filesystem>
#include <string>

namespace atrium::viewer {

/// A model or texture of a world that is not shown as the world's server has it, "model chair.obj",
/// or empty.
struct BadFiles {
    std::string missing;    // could not be read
    std::string differing;  // of which the server has another version
};

/// Says what to do about a file of a world that cannot be read from `folder`, the viewer's folder
/// of models: which folder to give if the file is not there, else `mend`, which mends the file.
std::string advice_about(const Error& failure,
                         const std::filesystem::path& folder,
                         const std::string& file,
                         const std::string& mend);

/// The line about a file of which the world's server has another version than `folder`. `kind`:
/// "model" or "texture".
std::string differs_line(const std::string& kind,
                         const std::string& file,
                         const std::filesystem::path& folder);

}  // namespace atrium::viewer
