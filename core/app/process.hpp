#pragma once

#include "core/config/option_set.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

/// The process that a program is: its priority and its age.
namespace atrium::app {

struct ProcessOptions {
    /// -20 goes first, 19 last. 0: as the process was started. Above 0 it is the least: a process
    /// that was started with more keeps that, so none of these needs rights. Below 0 does.
    int nice = 0;
};

/// Declares `process.nice`; `options` holds the program's default.
void declare(ProcessOptions& options, config::OptionSet& set);

/// Gives all threads of this process their niceness; threads that start later inherit it. Logs a
/// warning where the system refuses, and goes on with what it has. Returns the niceness that holds.
int apply(const ProcessOptions& options);

/// Time since the kernel started this process [s], in steps of a clock tick (10 ms); 0 where the
/// system does not tell.
double seconds_since_start();

/// Field 22 of a line of /proc/PID/stat: ticks from the start of the host to that of the process.
std::optional<std::uint64_t> parse_start_ticks(std::string_view stat);

}  // namespace atrium::app
