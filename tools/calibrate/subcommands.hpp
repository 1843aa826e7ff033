#pragma once

#include "core/base/expected.hpp"

#include <CLI/CLI.hpp>

#include <functional>
#include <string>

/// The subcommands of `calibrate`, one file each. Each adds itself to the command line, and sets
/// `action` if it is chosen.
namespace atrium::calibrate {

/// Does what the command line says and prints the result.
using Action = std::function<Expected<void>()>;

void add_import(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_wand(CLI::App& app, Action& action);
void add_refine(CLI::App& app, Action& action);
void add_check(CLI::App& app, Action& action);
void add_board(CLI::App& app, Action& action);
void add_print_board(CLI::App& app, Action& action);
void add_floor(CLI::App& app, Action& action);

/// The text for a command line that does not parse, from CLI11's reason: what is unexpected, with
/// the name that is probably meant, or what is missing, with its meaning.
std::string usage_error(const CLI::App& app, const std::string& reason);

}  // namespace atrium::calibrate
