#pragma once

#include "core/base/expected.hpp"

#include <filesystem>
#include <string>
#include <string_view>

namespace atrium::bus {

/// The whole file; kNotFound where it cannot be read.
Expected<std::string> read_text_file(const std::filesystem::path& file);

/// Checks that the text is XML with the root <CycloneDDS> and returns it without comments and
/// declaration, which is what Cyclone takes, each element on the line that it had; what stands in
/// it Cyclone checks itself. `source` names the text in errors.
Expected<std::string> parse_network_file(std::string_view xml, const std::string& source);

/// Of the file.
Expected<std::string> load_network_file(const std::filesystem::path& file);

}  // namespace atrium::bus
