#pragma once

#include "core/bus/bus.hpp"
#include "viewer/start/recent_worlds.hpp"
#include "viewer/ui/surface.hpp"

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>

namespace atrium::viewer {

/// Shows the start screen until the user joins a world. Empty: the user left, or a stop was
/// requested. `options`: the network to listen on at first. Removes from `recent` what the user
/// forgets. Main thread.
std::optional<bus::BusOptions> choose_world(Surface& surface,
                                            const bus::BusOptions& options,
                                            RecentWorlds& recent,
                                            const std::string& notice,
                                            std::stop_token stop);

/// Listens for `duration`, then describes the worlds heard and how to join one, for a terminal.
struct WorldReport {
    std::string text;
    bool has_worlds = false;
};
Expected<WorldReport> report_worlds(const bus::BusOptions& options,
                                    std::chrono::milliseconds duration,
                                    std::stop_token stop);

}  // namespace atrium::viewer
