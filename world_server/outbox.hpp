#pragma once

#include "core/bus/messages.hpp"
#include "world_server/scene.hpp"

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::world_server {

/// What waits to be published. The newest state replaces an unsent one; the newest change of an
/// object, or placement of a site, replaces the one before. Thread-safe; never blocks a writer.
class Outbox {
public:
    struct Content {
        std::vector<SceneChange> changes;
        std::vector<bus::SitePlacement> placements;
        std::vector<bus::Scenery> scenery;
        std::optional<bus::SceneState> state;
        std::vector<bus::SoftBodyState> soft_states;
    };

    /// `soft_states` are of the same moment.
    void put(bus::SceneState state, std::vector<bus::SoftBodyState> soft_states);
    void put(const bus::Scenery& scenery);
    void put(const SceneChange& change);
    void put(const bus::SitePlacement& placement);

    /// Waits until there is something, until `deadline`, or until a stop is requested.
    Content take(std::stop_token stop, std::chrono::steady_clock::time_point deadline);

private:
    bool has_content() const {
        return state_ || !changes_.empty() || !placements_.empty() || !scenery_.empty();
    }

    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<bus::SceneState> state_;
    std::vector<bus::SoftBodyState> soft_states_;
    std::vector<bus::Scenery> scenery_;
    std::map<std::uint32_t, SceneChange> changes_;
    std::map<std::string, bus::SitePlacement> placements_;
};

}  // namespace atrium::world_server
