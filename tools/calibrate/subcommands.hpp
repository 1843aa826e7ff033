#pragma once

#include "core/base/expected.hpp"

#include <CLI/CLI.hpp>

#include <functional>

/// The subcommands of `calibrate`, one file each. Each adds itself to the command line, and sets
/// `action` if it is chosen.
namespace atrium::calibrate {

/// Does what the command line says and prints the result.
using Action = std::function<Expected<void>()>;

void add_import(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);

}  // namespace atrium::calibrate
