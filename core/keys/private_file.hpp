#pragma once

#include "core/base/expected.hpp"

#include <cstddef>
#include <filesystem>
#include <string>

/// Files with private keys.
namespace atrium::keys {

/// Reads a file that only its owner can read: mode 0600, 0400 or less. A credential of systemd is
/// also accepted: 0440 of root. Fails with kNotFound if the file cannot be read, with
/// kConfiguration if others can read it (the message has the command that mends it), if it is no
/// regular file, or if it is larger than `max_bytes`. With `is_ours`, the mode counts only if it
/// says so of the text: nobody may be told to close another file, such as /etc/passwd.
Expected<std::string> read_private_file(const std::filesystem::path& file,
                                        std::size_t max_bytes,
                                        bool (*is_ours)(const std::string& text) = nullptr);

enum class Existing : bool { kKeep, kReplace };

/// Writes a file with mode 0600 under a temporary name and renames it: a reader sees all or
/// nothing, also after a crash. With kKeep it fails with kConfiguration if the file exists; else
/// with kUnavailable and the cure.
Expected<void> write_private_file(const std::filesystem::path& file,
                                  const std::string& text,
                                  Existing existing);

}  // namespace atrium::keys
