#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// A LatestSlot per site, emptied together: holds at most one value of each site, a newer `put`
/// replaces one that was not taken. Sites are served in turn. Safe for any number of threads.
template <typename T>
class NewestPerSite {
public:
    struct Item {
        std::string site;
        T value;
    };

    /// Returns the value that it replaced, if any.
    std::optional<T> put(const std::string& site, T value) {
        std::optional<T> replaced;
        {
            const std::lock_guard lock(mutex_);
            const auto found = values_.find(site);
            if (found == values_.end()) {
                values_.emplace(site, std::move(value));
            } else {
                replaced = std::exchange(found->second, std::move(value));
            }
        }
        changed_.notify_one();
        return replaced;
    }

    /// Waits for a value of any site; nullopt once a stop is requested, even while there are
    /// values: a taker that does not keep up would otherwise never end.
    std::optional<Item> take(std::stop_token stop) {
        std::unique_lock lock(mutex_);
        if (stop.stop_requested()) return std::nullopt;
        if (!changed_.wait(lock, stop, [this] { return !values_.empty(); })) return std::nullopt;
        auto next = values_.upper_bound(last_site_);
        if (next == values_.end()) next = values_.begin();
        auto node = values_.extract(next);
        last_site_ = node.key();
        return Item{std::move(node.key()), std::move(node.mapped())};
    }

    /// What is there now, of every site; never waits.
    std::vector<Item> take_all() {
        const std::lock_guard lock(mutex_);
        std::vector<Item> items;
        for (auto& [site, value] : values_) items.push_back({site, std::move(value)});
        values_.clear();
        return items;
    }

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::map<std::string, T> values_;
    std::string last_site_;
};

}  // namespace atrium::viewer
