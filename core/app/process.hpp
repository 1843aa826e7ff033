#pragma once

#include "core/config/option_set.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

/// Sets the priority of this process and measures its age.
namespace atrium::app {

struct ProcessOptions {
    /// Niceness: -20 is the highest priority, 19 the lowest. 0 keeps the process as it was started.
    /// Above 0 it is a minimum: a process started with more keeps that, thus no privilege is
    /// needed. Below 0 needs one.
    int nice = 0;
};

/// Declares `process.nice`; `options` holds the program's default.
void declare(ProcessOptions& options, config::OptionSet& set);

/// Sets the niceness of all threads of this process; later threads inherit it. If the system
/// refuses, logs a warning and continues. Returns the resulting niceness.
int apply(const ProcessOptions& options);

/// Returns the age of this process [s], in steps of a clock tick (10 ms); 0 if unknown.
double seconds_since_start();

/// Parses field 22 of /proc/PID/stat: clock ticks from the boot of the host to the start of the
/// process. Returns nullopt if the line is malformed.
std::optional<std::uint64_t> parse_start_ticks(std::string_view stat);

/// Returns the folder of this process's executable, links resolved. Empty if /proc does not tell.
std::filesystem::path program_folder();

}  // namespace atrium::app
