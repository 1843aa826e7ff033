#include "world_server/people_inbox.hpp"

#include <utility>

namespace atrium::world_server {

void PeopleInbox::put(const std::string& site, std::optional<physics::PersonShape> shape) {
    // the replaced shape is freed after the lock is released
    const std::lock_guard lock(mutex_);
    std::swap(news_[site], shape);
}

void PeopleInbox::take_all(
    const std::function<void(const std::string& site, std::optional<physics::PersonShape>&& shape)>&
        visit) {
    std::map<std::string, std::optional<physics::PersonShape>> news;
    {
        const std::lock_guard lock(mutex_);
        news.swap(news_);
    }
    for (auto& [site, shape] : news) visit(site, std::move(shape));
}

}  // namespace atrium::world_server
