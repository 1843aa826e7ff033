#include "world_server/outbox.hpp"

#include <utility>

namespace atrium::world_server {

void Outbox::put(bus::SceneState state, std::vector<bus::SoftBodyState> soft_states) {
    {
        const std::lock_guard lock(mutex_);
        state_ = std::move(state);
        soft_states_ = std::move(soft_states);
    }
    changed_.notify_one();
}

void Outbox::put(const bus::Scenery& scenery) {
    {
        const std::lock_guard lock(mutex_);
        scenery_.push_back(scenery);
    }
    changed_.notify_one();
}

void Outbox::put(const SceneChange& change) {
    {
        const std::lock_guard lock(mutex_);
        changes_[change.object.object] = change;
    }
    changed_.notify_one();
}

void Outbox::put(const bus::SitePlacement& placement) {
    {
        const std::lock_guard lock(mutex_);
        placements_[placement.site] = placement;
    }
    changed_.notify_one();
}

Outbox::Content Outbox::take(std::stop_token stop, std::chrono::steady_clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, stop, deadline, [this] { return has_content(); });
    Content content;
    content.state = std::exchange(state_, std::nullopt);
    content.soft_states = std::exchange(soft_states_, {});
    content.scenery = std::exchange(scenery_, {});
    for (auto& [id, change] : changes_) content.changes.push_back(std::move(change));
    for (auto& [site, placement] : placements_) content.placements.push_back(std::move(placement));
    changes_.clear();
    placements_.clear();
    return content;
}

}  // namespace atrium::world_server
