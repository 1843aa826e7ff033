#pragma once

#include "viewer/receive/session.hpp"

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Buffers people for delayed playback. Releases the newest due person of each site. Not
/// thread-safe.
class DelayedPeople {
public:
    struct Item {
        std::string site;
        PersonUpdate update;
    };

    /// Adds an update. Passes updates that will never be shown to `replaced`, because a newer one
    /// is due or the buffer is full.
    template <typename Replaced>
    void add(const std::string& site, PersonUpdate update, const Replaced& replaced);
    /// Takes the updates to show from `instant` on, one per site at most. An update without a
    /// person is due as soon as those before it are.
    template <typename Replaced>
    std::vector<Item> take(Timestamp instant, const Replaced& replaced);
    void clear() { waiting_.clear(); }

private:
    static constexpr std::size_t kMaxWaiting = 16;  // per site: half a second

    std::map<std::string, std::deque<PersonUpdate>> waiting_;  // in order of arrival
};

template <typename Replaced>
void DelayedPeople::add(const std::string& site, PersonUpdate update, const Replaced& replaced) {
    std::deque<PersonUpdate>& waiting = waiting_[site];
    waiting.push_back(std::move(update));
    if (waiting.size() <= kMaxWaiting) return;
    replaced(std::move(waiting.front()));
    waiting.pop_front();
}

template <typename Replaced>
std::vector<DelayedPeople::Item> DelayedPeople::take(Timestamp instant, const Replaced& replaced) {
    std::vector<Item> due;
    for (auto& [site, waiting] : waiting_) {
        std::optional<PersonUpdate> newest;
        while (!waiting.empty() &&
               (!waiting.front().model || waiting.front().capture_time <= instant)) {
            if (newest) replaced(std::move(*newest));
            newest = std::move(waiting.front());
            waiting.pop_front();
        }
        if (newest) due.push_back({site, std::move(*newest)});
    }
    std::erase_if(waiting_, [](const auto& site) { return site.second.empty(); });
    return due;
}

}  // namespace atrium::viewer
