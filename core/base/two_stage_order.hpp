#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

namespace atrium {

/// Passes values through two concurrent stages, one thread each: the first turns each `Offered`
/// into a `Made`, the second takes it. The newest value wins: at most one waits before each stage.
///
/// A value that waits for the second stage is dropped when the first begins a newer one. Values are
/// thus dropped exactly when a single thread for both stages would drop them: if a newer one comes
/// before the second stage is free. The order is kept, and every drop is counted.
///
/// Thread-safe; only one thread at a time may call the functions of a stage.
template <typename Offered, typename Made>
class TwoStageOrder {
public:
    struct Begun {
        Offered value;
        std::optional<Made> dropped;  // dropped before the second stage; its memory can be reused
    };

    /// Offers a new value to the first stage. Replaces one that it has not begun.
    void offer(Offered value) {
        {
            const std::lock_guard lock(mutex_);
            if (offered_) ++num_dropped_;
            offered_ = std::move(value);
        }
        was_offered_.notify_one();
    }

    /// First stage: waits for a value and begins it; nullopt if a stop is requested.
    std::optional<Begun> begin(std::stop_token stop) {
        std::unique_lock lock(mutex_);
        if (!was_offered_.wait(lock, stop, [this] { return offered_.has_value(); }))
            return std::nullopt;
        Begun begun{*std::exchange(offered_, std::nullopt), std::nullopt};
        // a value handed to a free second stage counts as begun there
        if (made_ && !is_second_free_) {
            begun.dropped = std::exchange(made_, std::nullopt);
            ++num_dropped_;
        }
        return begun;
    }

    /// First stage: passes its result to the second. Replaces a value that the second stage, though
    /// free, has not taken yet.
    void hand_over(Made value) {
        {
            const std::lock_guard lock(mutex_);
            if (made_) ++num_dropped_;
            made_ = std::move(value);
        }
        was_made_.notify_one();
    }

    /// Second stage: waits for a value and takes it; nullopt if a stop is requested.
    std::optional<Made> take(std::stop_token stop) {
        std::unique_lock lock(mutex_);
        is_second_free_ = true;
        const bool is_there = was_made_.wait(lock, stop, [this] { return made_.has_value(); });
        is_second_free_ = false;
        if (!is_there) return std::nullopt;
        return std::exchange(made_, std::nullopt);
    }

    std::uint64_t num_dropped() const {
        const std::lock_guard lock(mutex_);
        return num_dropped_;
    }

private:
    mutable std::mutex mutex_;
    std::condition_variable_any was_offered_;
    std::condition_variable_any was_made_;
    std::optional<Offered> offered_;
    std::optional<Made> made_;
    bool is_second_free_ = false;
    std::uint64_t num_dropped_ = 0;
};

}  // namespace atrium
