#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <unordered_map>

namespace atrium::bus {

/// Counts the deadlines that the keys of a reader have missed, whenever a key is heard of again.
/// One thread at a time, but for `num_missed`.
class DeadlineCount {
public:
    using Clock = std::chrono::steady_clock;

    explicit DeadlineCount(std::chrono::nanoseconds deadline) : deadline_(deadline) {}

    /// A sample of the key has come.
    void heard(std::uint64_t key, Clock::time_point now) {
        if (deadline_ == std::chrono::nanoseconds::max()) return;
        const auto [entry, is_new] = last_.try_emplace(key, now);
        if (is_new) return;
        num_missed_ += static_cast<std::uint64_t>((now - entry->second) / deadline_);
        entry->second = now;
    }
    /// The key is no longer written: nothing is expected of it.
    void gone(std::uint64_t key) { last_.erase(key); }

    std::uint64_t num_missed() const { return num_missed_; }

private:
    std::chrono::nanoseconds deadline_;
    std::unordered_map<std::uint64_t, Clock::time_point> last_;  // no more keys than the reader has
    std::atomic<std::uint64_t> num_missed_ = 0;
};

}  // namespace atrium::bus
