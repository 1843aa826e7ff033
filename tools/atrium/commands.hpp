#pragma once

#include "core/base/expected.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// The front command: `atrium NAME ...` runs the program `atrium-NAME` beside it, as git does.
/// Each tool stays a program of its own, which links only what it needs.
namespace atrium::front {

struct Command {
    std::string name;
    std::string summary;  // one line; empty for a program that Atrium does not ship
};

/// The commands that Atrium ships, in the order of `atrium help`.
std::span<const Command> shipped_commands();

/// The commands whose program is in `folder`: shipped ones first, then other executables named
/// `atrium-NAME`, by name.
std::vector<Command> installed_commands(const std::filesystem::path& folder);

/// The text of `atrium help`.
std::string help(std::span<const Command> installed);

/// Finds the program for a command line, and returns its path and arguments.
///
/// `words` are the arguments of the front command, at least one. `help NAME` becomes
/// `NAME --help`. Errors: kConfiguration for an unknown command, with the one that may be meant;
/// kNotFound for a shipped command whose program is not in `folder`.
Expected<std::vector<std::string>> program_for(std::span<const std::string> words,
                                               const std::filesystem::path& folder);

}  // namespace atrium::front
