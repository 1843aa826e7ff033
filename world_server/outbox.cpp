#include "world_server/outbox.hpp"

#include <iterator>
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

void Outbox::replace(const std::vector<bus::Scenery>& gone,
                     const std::vector<bus::Scenery>& scenery) {
    {
        const std::lock_guard lock(mutex_);
        gone_scenery_.insert(gone_scenery_.end(), gone.begin(), gone.end());
        scenery_ = scenery;
    }
    changed_.notify_one();
}

void Outbox::put(bus::EditResult result) {
    constexpr std::size_t kMaxResults = 256;
    {
        const std::lock_guard lock(mutex_);
        if (results_.size() >= kMaxResults) results_.pop_front();
        results_.push_back(std::move(result));
    }
    changed_.notify_one();
}

void Outbox::leave(const std::string& sender) {
    constexpr std::size_t kMaxLeft = 1024;  // as many as the bus keeps
    {
        const std::lock_guard lock(mutex_);
        if (left_.size() < kMaxLeft) left_.push_back(sender);
    }
    changed_.notify_one();
}

void Outbox::put(bus::SavedWorlds saved_worlds) {
    {
        const std::lock_guard lock(mutex_);
        saved_worlds_ = std::move(saved_worlds);
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
    content.gone_scenery = std::exchange(gone_scenery_, {});
    content.saved_worlds = std::exchange(saved_worlds_, std::nullopt);
    content.results.assign(std::make_move_iterator(results_.begin()),
                           std::make_move_iterator(results_.end()));
    results_.clear();
    content.left = std::exchange(left_, {});
    for (auto& [id, change] : changes_) content.changes.push_back(std::move(change));
    for (auto& [site, placement] : placements_) content.placements.push_back(std::move(placement));
    changes_.clear();
    placements_.clear();
}

}  // namespace atrium::world_server
