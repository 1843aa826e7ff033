#include "world_server/outbox.hpp"

#include <utility>

namespace atrium::world_server {

void Outbox::put(MovedState& state) {
    {
        const std::lock_guard lock(mutex_);
        std::swap(state_, state);
        has_state_ = true;
    }
    changed_.notify_one();
}

void Outbox::put(std::vector<physics::PersonSnapshot>& people) {
    {
        const std::lock_guard lock(mutex_);
        std::swap(people_, people);
        has_people_ = true;
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

void Outbox::take(Content& content,
                  std::stop_token stop,
                  std::chrono::steady_clock::time_point deadline) {
    content.changes.clear();
    content.placements.clear();
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, stop, deadline, [this] { return has_content(); });
    content.has_state = std::exchange(has_state_, false);
    if (content.has_state) std::swap(content.state, state_);
    content.has_people = std::exchange(has_people_, false);
    if (content.has_people) std::swap(content.people, people_);
    content.scenery = std::exchange(scenery_, {});
    for (auto& [id, change] : changes_) content.changes.push_back(std::move(change));
    for (auto& [site, placement] : placements_) content.placements.push_back(std::move(placement));
    changes_.clear();
    placements_.clear();
}

}  // namespace atrium::world_server
