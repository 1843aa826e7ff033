#pragma once

#include "core/bus/messages.hpp"
#include "world_server/scene.hpp"

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
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
    void put(const SceneChange& change);
    void put(const bus::SitePlacement& placement);

    /// Waits for content, `deadline` or a stop request. Overwrites `content` and reuses its memory.
    void take(Content& content,
              std::stop_token stop,
              std::chrono::steady_clock::time_point deadline);

private:
    bool has_content() const {
        return has_state_ || has_people_ || !changes_.empty() || !placements_.empty() ||
               !scenery_.empty();
    }

    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool has_state_ = false;
    MovedState state_;
    bool has_people_ = false;
    std::vector<physics::PersonSnapshot> people_;
    std::vector<bus::Scenery> scenery_;
    std::map<std::uint32_t, SceneChange> changes_;
    std::map<std::string, bus::SitePlacement> placements_;
};

}  // namespace atrium::world_server
