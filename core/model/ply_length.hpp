#pragma once

#include <filesystem>
#include <string>

namespace atrium::model {

/// What is missing of a PLY file that was cut off: "is cut off: has 5 of 8 faces". Empty: nothing.
/// Assimp reads a header without an end for ever, and takes the part of the data that is there for
/// the whole.
std::string what_ply_lacks(const std::filesystem::path& file);

}  // namespace atrium::model
