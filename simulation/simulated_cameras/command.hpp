#pragma once

#include "core/base/expected.hpp"

#include <sys/types.h>

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::simulated_cameras {

/// Runs `command` (found in PATH, as in a shell) with this process' network, terminal and
/// environment, and waits for its end. Once `stop` is requested the command is asked to end, and
/// ended after ten seconds. `on_signal` is called for each SIGUSR1 that this process gets; the
/// signal must be blocked in all threads (`block_usr1`). An empty command is one that ends with the
/// stop.
///
/// Returns its exit code, 128 + signal where a signal ended it. Error kNotFound where there is no
/// such program.
Expected<int> run_command(const std::vector<std::string>& command,
                          std::stop_token stop,
                          const std::function<void()>& on_signal);

/// Blocks SIGUSR1; before any thread is started.
void block_usr1();

}  // namespace atrium::simulated_cameras
