#pragma once

#include "core/base/expected.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace atrium::viewer {

/// Folder of the user's own files: $XDG_STATE_HOME/atrium, else ~/.local/state/atrium. Empty
/// without a home.
std::optional<std::filesystem::path> user_folder();

/// Replaces the file, so a reader or a crash finds the old or the new one. Creates its folder.
/// Error kUnavailable with the reason.
Expected<void> replace_file(const std::filesystem::path& file, const std::string& text);

/// Keeps a damaged file under another name before it is replaced: FILE.damaged.
void keep_damaged(const std::filesystem::path& file);

/// TOML string with its quotes.
std::string quoted(const std::string& text);

}  // namespace atrium::viewer
