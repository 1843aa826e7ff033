#pragma once

#include "core/bus/messages.hpp"
#include "world_server/command_rights.hpp"

#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace atrium::world_server {

/// Queues commands from the receiving thread until the next tick of the simulating thread.
///
/// Holds at most 256 commands in the order of arrival. Refuses further ones, and those that the
/// rights do not allow. Thread-safe.
class CommandInbox {
public:
    struct Content {
        std::vector<bus::SceneCommand> commands;
        std::set<std::string> left;  // senders that have left, after their last command
    };

    explicit CommandInbox(const Rights& rights) : rights_(rights), rates_(rights.max_per_s) {}

    /// Queues a command. Returns the reason if it was refused.
    std::optional<std::string> put(bus::SceneCommand&& command,
                                   CommandRates::Clock::time_point now);
    void leave(const std::string& sender);
    Content take_all();

private:
    const Rights rights_;
    std::mutex mutex_;
    CommandRates rates_;
    Content content_;
};

}  // namespace atrium::world_server
