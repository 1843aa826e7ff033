#include "viewer/receive/decoded_people.hpp"

#include <utility>

namespace atrium::viewer {

std::optional<PersonUpdate> DecodedPeople::put(const std::string& site, PersonUpdate update) {
    std::optional<PersonUpdate> replaced;
    {
        const std::lock_guard lock(mutex_);
        if (arrivals_.size() >= kMostArrivals) arrivals_.erase(arrivals_.begin());
        arrivals_.push_back({site, update.ready});
        const auto found = newest_.find(site);
        if (found == newest_.end())
            newest_.emplace(site, std::move(update));
        else
            replaced = std::exchange(found->second, std::move(update));
    }
    changed_.notify_one();
    return replaced;
}

std::vector<DecodedPeople::Item> DecodedPeople::take_all() {
    std::map<std::string, PersonUpdate> taken;
    {
        const std::lock_guard lock(mutex_);
        taken.swap(newest_);
    }
    std::vector<Item> items;
    for (auto& [site, update] : taken) items.push_back({site, std::move(update)});
    return items;
}

std::vector<DecodedPeople::Arrival> DecodedPeople::take_arrivals() {
    const std::lock_guard lock(mutex_);
    return std::exchange(arrivals_, {});
}

void DecodedPeople::wait(const std::stop_token& stop, Clock::time_point until) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, stop, until, [this] { return !arrivals_.empty(); });
}

}  // namespace atrium::viewer
