#pragma once

#include "core/bus/messages.hpp"
#include "world_server/scene.hpp"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::world_server {

/// The state of everything that moves, at one moment.
struct MovedState {
    bus::SceneState rigid;
    std::vector<bus::SoftBodyState> soft;
};

/// Hands data from the simulating to the publishing thread.
///
/// The newest state replaces an unsent one. The newest change of an object and the newest placement
/// of a site replace the previous one. Thread-safe. Never blocks a writer for long. State memory
/// circulates: `put` returns an older state's memory for the next one.
class Outbox {
public:
    struct Content {
        std::vector<SceneChange> changes;
        std::vector<bus::SitePlacement> placements;
        std::vector<bus::Scenery> scenery;
        std::vector<bus::Scenery> gone_scenery;  // disposed before `scenery` is written
        std::vector<bus::EditResult> results;
        std::vector<std::string> left;  // senders whose results are disposed after `results`
        std::optional<bus::SavedWorlds> saved_worlds;
        bool has_state = false;
        MovedState state;  // left over from an earlier call if `has_state` is false
        bool has_people = false;
        std::vector<physics::PersonSnapshot> people;  // left over if `has_people` is false
    };

    /// Swaps `state` with an older or empty one.
    void put(MovedState& state);
    /// Like the above, for all people in the world.
    void put(std::vector<physics::PersonSnapshot>& people);
    void put(const bus::Scenery& scenery);
    /// Replaces all scenery.
    void replace(const std::vector<bus::Scenery>& gone, const std::vector<bus::Scenery>& scenery);
    /// At most 256 results wait; a further one replaces the oldest.
    void put(bus::EditResult result);
    /// A sender has left: nobody waits for its results.
    void leave(const std::string& sender);
    void put(bus::SavedWorlds saved_worlds);
    void put(const SceneChange& change);
    void put(const bus::SitePlacement& placement);

    /// Waits for content, `deadline` or a stop request. Overwrites `content` and reuses its memory.
    void take(Content& content,
              std::stop_token stop,
              std::chrono::steady_clock::time_point deadline);

private:
    bool has_content() const {
        return has_state_ || has_people_ || !changes_.empty() || !placements_.empty() ||
               !scenery_.empty() || !gone_scenery_.empty() || !results_.empty() || !left_.empty() ||
               saved_worlds_;
    }

    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool has_state_ = false;
    MovedState state_;
    bool has_people_ = false;
    std::vector<physics::PersonSnapshot> people_;
    std::vector<bus::Scenery> scenery_;
    std::vector<bus::Scenery> gone_scenery_;
    std::deque<bus::EditResult> results_;
    std::vector<std::string> left_;
    std::optional<bus::SavedWorlds> saved_worlds_;
    std::map<std::uint32_t, SceneChange> changes_;
    std::map<std::string, bus::SitePlacement> placements_;
};

}  // namespace atrium::world_server
