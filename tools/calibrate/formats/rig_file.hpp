#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/formats/data_tree.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// The text of a rig.toml (docs/conventions.md#recordings). `comments` become lines at its top.
/// Numbers are written so that reading them gives the same bits. Bounds are left out if empty.
std::string rig_text(const config::Rig& rig, const std::vector<std::string>& comments);

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
