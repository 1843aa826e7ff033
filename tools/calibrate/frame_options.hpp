#pragma once

#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/finish_calibration.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <optional>
#include <string>

/// Options that several subcommands share: what the user knows of the room.
namespace atrium::calibrate {

/// The number that all of `text` is, if it is in [low, high].
std::optional<double> parse_number(const std::string& text, double low, double high);

/// "3,18" may be 3.18: what to write instead. Empty if the text has no decimal comma.
std::string hint_of_comma(const std::string& text);

/// Width and height of "WIDTHxHEIGHT". Throws CLI::ValidationError, which names `option`.
std::array<int, 2> parse_size(const std::string& text, const char* option = "--size");

/// `--up`
void add_up_option(CLI::App& command, Said& said);

/// `--distance` and `--camera-height`
void add_distance_options(CLI::App& command, Said& said);

/// `--frame-of`, `--output`, `--report` and `--force` of a calibration
void add_finish_options(CLI::App& command, FinishOptions& finish);

}  // namespace atrium::calibrate
