#pragma once

#include <filesystem>
#include <string>

namespace Assimp {
class Importer;
}

namespace atrium::model {

/// Why Assimp could not read `file`, in the words of somebody who made or copied it: "is cut off:
/// has 1000 of 2312 bytes", "is a PNG picture, whatever its name says". What Assimp says if nothing
/// better is known.
///
/// A program that links this has failed assertions of Assimp as read errors: Debian's Assimp checks
/// them, and would end the program because of a damaged file.
std::string why_unreadable(const std::filesystem::path& file, const Assimp::Importer& importer);

}  // namespace atrium::model
