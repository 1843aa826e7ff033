#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace atrium::app {

/// Says what is wrong with the command line of a program with subcommands, in one line: an unknown
/// command or option with the one that was probably meant, and where help is; else what CLI11 says.
std::string usage_error(const CLI::App& cli, const CLI::ParseError& error);

}  // namespace atrium::app
