#pragma once

#include "core/base/expected.hpp"

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <set>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Reads values by key on its own thread, each once unless it is wanted again, and in order of
/// request, so the drawing thread never waits for a disk. At most kAhead results wait to be taken,
/// which bounds the memory.
template <typename Key, typename Value>
class BackgroundReader {
public:
    using Read = std::function<Expected<Value>(const Key&)>;
    using Result = std::pair<Key, Expected<Value>>;
    static constexpr std::size_t kAhead = 4;

    /// Calls `read` on the background thread.
    explicit BackgroundReader(Read read)
        : read_(std::move(read)), thread_([this](std::stop_token stop) { run(std::move(stop)); }) {}

    /// Requests `key`. Ignored if it was requested since the last `forget`.
    void want(const Key& key) {
        {
            const std::lock_guard lock(mutex_);
            if (!wanted_.insert(key).second) return;
            waiting_.push_back(key);
        }
        changed_.notify_one();
    }
    /// Requests `key` even if it was read before. It must not be waiting.
    void want_again(const Key& key) {
        {
            const std::lock_guard lock(mutex_);
            wanted_.insert(key);
            waiting_.push_back(key);
        }
        changed_.notify_one();
    }
    bool is_wanted(const Key& key) const {
        const std::lock_guard lock(mutex_);
        return wanted_.contains(key);
    }
    std::size_t num_wanted() const {
        const std::lock_guard lock(mutex_);
        return wanted_.size();
    }
    /// Whether everything that was requested has been read and taken.
    bool is_idle() const {
        const std::lock_guard lock(mutex_);
        return waiting_.empty() && results_.empty() && !is_reading_;
    }
    /// Returns the results since the last call, failures included. Never blocks.
    std::vector<Result> take() {
        std::vector<Result> results;
        {
            const std::lock_guard lock(mutex_);
            results.swap(results_);
        }
        if (!results.empty()) changed_.notify_one();
        return results;
    }
    /// Drops all requests and results. Keys may be requested again.
    void forget() {
        const std::lock_guard lock(mutex_);
        ++generation_;
        wanted_.clear();
        waiting_.clear();
        results_.clear();
    }

private:
    void run(std::stop_token stop) {
        std::unique_lock lock(mutex_);
        const auto has_work = [this] { return !waiting_.empty() && results_.size() < kAhead; };
        while (changed_.wait(lock, stop, has_work)) {
            const Key key = std::move(waiting_.front());
            waiting_.pop_front();
            const std::size_t generation = generation_;
            is_reading_ = true;
            lock.unlock();
            Expected<Value> value = read_(key);
            lock.lock();
            is_reading_ = false;
            if (generation == generation_) results_.emplace_back(key, std::move(value));
        }
    }

    Read read_;
    mutable std::mutex mutex_;  // guards the members below
    std::condition_variable_any changed_;
    std::set<Key> wanted_;     // all requests since `forget`
    std::deque<Key> waiting_;  // not read yet
    std::vector<Result> results_;
    std::size_t generation_ = 0;
    bool is_reading_ = false;
    std::jthread thread_;  // last: stops before the other members are destroyed
};

}  // namespace atrium::viewer
