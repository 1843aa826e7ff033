#pragma once

#include "world_server/simulation.hpp"

#include <optional>
#include <string>

namespace atrium::world_server {

/// Queues a command for the next tick. Returns the reason if it is refused; the sender then gets
/// its answer through the outbox. Thread-safe, like the others here.
std::optional<std::string> receive(Simulation& simulation,
                                   bus::SceneCommand&& command,
                                   CommandRates::Clock::time_point now);
/// Likewise for an edit. What needs files goes to the edit worker first.
std::optional<std::string> receive(Simulation& simulation,
                                   bus::SceneEdit&& edit,
                                   CommandRates::Clock::time_point now);

/// The sender of commands or edits has left.
void forget_sender(Simulation& simulation, const bus::SceneCommand& gone);
void forget_sender(Simulation& simulation, const bus::SceneEdit& gone);

}  // namespace atrium::world_server
