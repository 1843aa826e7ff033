#pragma once

#include "core/base/expected.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace atrium::bus {

/// Error for text that is not XML: what is wrong at which line. `offset` in bytes.
tl::unexpected<Error> malformed_xml(std::string_view xml,
                                    const std::string& source,
                                    std::string_view what,
                                    std::ptrdiff_t offset);

/// Checks that the text is XML with the root <CycloneDDS>, and returns it without comments and
/// declaration, as Cyclone expects it. Each element keeps its line number for Cyclone's errors.
/// Cyclone checks the contents itself. `source` names the text in errors (kConfiguration).
Expected<std::string> parse_network_file(std::string_view xml, const std::string& source);

/// Reads and parses a file. If it cannot be read: kConfiguration for a single word (a mistyped
/// network name), else kNotFound.
Expected<std::string> load_network_file(const std::filesystem::path& file);

}  // namespace atrium::bus
