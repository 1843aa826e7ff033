#pragma once

#include "core/bus/messages.hpp"
#include "world_server/command_rights.hpp"
#include "world_server/config.hpp"
#include "world_server/description/model_parts.hpp"

#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace atrium::world_server {

/// An edit with what it needs from files.
struct PreparedEdit {
    bus::SceneEdit edit;
    ModelParts parts;                                // of a model to add; null: none
    std::shared_ptr<const WorldServerConfig> world;  // to load; null: none
};

/// Queues commands from the receiving thread until the next tick of the simulating thread.
///
/// Holds at most 256 commands and 256 edits, each in the order of arrival. Refuses further ones,
/// and those that the rights do not allow. Thread-safe.
class CommandInbox {
public:
    struct Content {
        std::vector<bus::SceneCommand> commands;
        std::vector<PreparedEdit> edits;
        std::set<std::string> left;  // senders that have left, after their last command
    };

    explicit CommandInbox(const Rights& rights) : rights_(rights), rates_(rights.max_per_s) {}

    /// Queues a command. Returns the reason if it was refused.
    std::optional<std::string> put(bus::SceneCommand&& command,
                                   CommandRates::Clock::time_point now);
    /// Counts an edit and checks the rights of its sender. Returns the reason if it is refused.
    std::optional<std::string> admit(const bus::SceneEdit& edit,
                                     CommandRates::Clock::time_point now);
    /// Queues an admitted edit. False if too many wait.
    bool put_prepared(PreparedEdit edit);
    void leave(const std::string& sender);
    Content take_all();

private:
    const Rights rights_;
    std::mutex mutex_;
    CommandRates rates_;
    Content content_;
};

}  // namespace atrium::world_server
