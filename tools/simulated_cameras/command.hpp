#pragma once

#include "core/base/expected.hpp"

#include <sys/types.h>

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::simulated_cameras {

/// Runs `command` (found in PATH, as in a shell) in this process' network, terminal and
/// environment, and waits for its end. After a stop request it terminates the command, and kills it
/// after ten seconds. Calls `on_signal` for each SIGUSR1 to this process; all threads must block
/// the signal (`block_usr1`). An empty command lasts until the stop.
///
/// Returns the exit code, or 128 + signal after a death by signal. Error kNotFound if the program
/// does not exist.
Expected<int> run_command(const std::vector<std::string>& command,
                          std::stop_token stop,
                          const std::function<void()>& on_signal);

/// Blocks SIGUSR1. Call it before any thread starts.
void block_usr1();

}  // namespace atrium::simulated_cameras
