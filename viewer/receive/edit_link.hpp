#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What came from the world server about edits since the last call of `EditLink::take`.
struct EditNews {
    std::vector<bus::EditResult> results;          // of this viewer's edits
    std::vector<bus::EditResult> of_others;        // done, of an object
    std::optional<bus::SavedWorlds> saved_worlds;  // newest list
    bool is_server_gone = false;                   // the server that sent lists has left
};

/// Sends edits of the world and receives their results and the list of saved worlds. One thread
/// may call `receive`, any other `send` and `take`.
class EditLink {
public:
    /// Receives the results of edits of `viewer`. `waiter` wakes for them.
    static Expected<EditLink> create(const bus::Participant& participant,
                                     bus::Waiter& waiter,
                                     std::string viewer);

    Expected<std::size_t> send(const bus::SceneEdit& edit) { return edits_.write(edit); }
    /// Takes samples. Returns the report of those that were refused, if any.
    bus::TakeReport receive();
    EditNews take();

private:
    EditLink(bus::Writer<bus::SceneEdit> edits,
             bus::Reader<bus::EditResult> results,
             bus::Reader<bus::SavedWorlds> saved_worlds,
             std::string viewer);

    bus::Writer<bus::SceneEdit> edits_;
    bus::Reader<bus::EditResult> results_;
    bus::Reader<bus::SavedWorlds> saved_worlds_;
    std::string viewer_;
    std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
    EditNews news_;  // guarded by mutex_
};

}  // namespace atrium::viewer
