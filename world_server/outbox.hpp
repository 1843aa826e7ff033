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

/// Where everything that moves is, at one moment.
struct MovedState {
    bus::SceneState rigid;
    std::vector<bus::SoftBodyState> soft;
};

/// What waits to be published. The newest state replaces an unsent one; the newest change of an
/// object, or placement of a site, replaces the one before. Thread-safe; never blocks a writer.
/// States go round in memory that is used again: who puts one gets an older one's for the next.
class Outbox {
public:
    struct Content {
        std::vector<SceneChange> changes;
        std::vector<bus::SitePlacement> placements;
        std::vector<bus::Scenery> scenery;
        bool has_state = false;
        MovedState state;  // of before where `has_state` is false
        bool has_people = false;
        std::vector<physics::PersonNow> people;  // likewise
    };

    /// Leaves an older state, or an empty one, in the place of `state`.
    void put(MovedState& state);
    /// Likewise: everybody who is there.
    void put(std::vector<physics::PersonNow>& people);
    void put(const bus::Scenery& scenery);
    void put(const SceneChange& change);
    void put(const bus::SitePlacement& placement);

    /// Waits until there is something, until `deadline`, or until a stop is requested. What was in
    /// `content` is lost, but for its memory.
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
    std::vector<physics::PersonNow> people_;
    std::vector<bus::Scenery> scenery_;
    std::map<std::uint32_t, SceneChange> changes_;
    std::map<std::string, bus::SitePlacement> placements_;
};

}  // namespace atrium::world_server
