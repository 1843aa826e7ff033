#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

namespace atrium {

/// Hands the newest value from one stage to another. Holds at most one value; a newer `put`
/// replaces a value that was not taken. Each value is taken at most once. Thread-safe.
template <typename T>
class LatestSlot {
public:
    /// Stores a value. Returns true if it replaced one that was not taken; `num_dropped` counts it.
    bool put(T value) {
        bool dropped = false;
        {
            const std::lock_guard lock(mutex_);
            dropped = value_.has_value();
            value_ = std::move(value);
            if (dropped) ++num_dropped_;
        }
        changed_.notify_one();
        return dropped;
    }

    /// Waits for a value and takes it; nullopt if a stop is requested.
    std::optional<T> take(std::stop_token stop) {
        std::unique_lock lock(mutex_);
        if (!changed_.wait(lock, stop, [this] { return value_.has_value(); })) return std::nullopt;
        return std::exchange(value_, std::nullopt);
    }

    /// Like `take`, but also returns nullopt at `deadline`.
    std::optional<T> take_until(std::stop_token stop,
                                std::chrono::steady_clock::time_point deadline) {
        std::unique_lock lock(mutex_);
        if (!changed_.wait_until(lock, stop, deadline, [this] { return value_.has_value(); }))
            return std::nullopt;
        return std::exchange(value_, std::nullopt);
    }

    /// Takes the value, if there is one; never waits.
    std::optional<T> try_take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(value_, std::nullopt);
    }

    std::uint64_t num_dropped() const {
        const std::lock_guard lock(mutex_);
        return num_dropped_;
    }

private:
    mutable std::mutex mutex_;
    std::condition_variable_any changed_;
    std::optional<T> value_;
    std::uint64_t num_dropped_ = 0;
};

}  // namespace atrium
