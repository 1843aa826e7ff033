#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <unordered_map>

namespace atrium::bus {

/// Counts the deadline periods that the instances of a reader missed. Adds them when the next
/// sample of the instance arrives. One thread at a time; `num_missed` is thread-safe.
class DeadlineCount {
public:
    using Clock = std::chrono::steady_clock;

    explicit DeadlineCount(std::chrono::nanoseconds deadline) : deadline_(deadline) {}

    /// Call it when a sample of the instance has arrived.
    void heard(std::uint64_t key, Clock::time_point now) {
        if (deadline_ == std::chrono::nanoseconds::max()) return;
        const auto [entry, is_new] = last_.try_emplace(key, now);
        if (is_new) return;
        num_missed_ += static_cast<std::uint64_t>((now - entry->second) / deadline_);
        entry->second = now;
    }
    /// Call it when the instance is no longer alive: no more samples are expected.
    void gone(std::uint64_t key) { last_.erase(key); }

    std::uint64_t num_missed() const { return num_missed_; }

private:
    std::chrono::nanoseconds deadline_;
    std::unordered_map<std::uint64_t, Clock::time_point> last_;  // one per instance of the reader
    std::atomic<std::uint64_t> num_missed_ = 0;
};

}  // namespace atrium::bus
