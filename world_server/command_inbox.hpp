#pragma once

#include "core/bus/messages.hpp"
#include "world_server/rights.hpp"

#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace atrium::world_server {

/// The commands that wait for the next tick, in the order of their arrival, from the thread that
/// receives to the one that simulates: at most 256; what is more, or not allowed, is refused.
/// Thread-safe.
class CommandInbox {
public:
    struct Content {
        std::vector<bus::SceneCommand> commands;
        std::set<std::string> left;  // senders that are gone, after their last command
    };

    explicit CommandInbox(const Rights& rights) : rights_(rights), rates_(rights.max_per_s) {}

    /// Why it was refused; nothing where it waits.
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
