#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig_text.hpp"
#include "tools/calibrate/formats/data_tree.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::calibrate {

using config::rig_text;

/// Whether a file of TOML is a rig, as an import writes it.
bool is_rig(const Tree& toml);

/// The same of a file, which need not be TOML nor exist.
bool is_rig_file(const std::filesystem::path& file);

/// Writes `text` to a new file; replaces an old one only if `may_replace`. Errors kConfiguration if
/// it exists, kUnavailable if it cannot be written.
Expected<void> write_text(const std::filesystem::path& file,
                          const std::string& text,
                          bool may_replace);

}  // namespace atrium::calibrate
