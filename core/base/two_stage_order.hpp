#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

namespace atrium {

/// Hands values through two stages that work at the same time, on one thread each: the first makes
/// a `Made` of each `Offered`, the second takes it. Newest wins, and at most one value waits in
/// front of each stage.
///
/// What waits for the second stage is dropped when the first begins with something newer. So a
/// value is dropped exactly where one thread that did both stages would drop it: where a newer one
/// came before the second stage was free. What the second stage takes is therefore never behind
/// something newer that would have been used instead. Order is kept, and every drop is counted.
///
/// Thread-safe; the calls of a stage come from one thread at a time.
template <typename Offered, typename Made>
class TwoStageOrder {
public:
    struct Begun {
        Offered value;
        std::optional<Made> dropped;  // what had waited for the second stage, for its memory
    };

    /// A new value for the first stage. Replaces one that was not begun.
    void offer(Offered value) {
        {
            const std::lock_guard lock(mutex_);
            if (offered_) ++num_dropped_;
            offered_ = std::move(value);
        }
        was_offered_.notify_one();
    }

    /// First stage: waits for a value; nullopt once a stop is requested.
    std::optional<Begun> begin(std::stop_token stop) {
        std::unique_lock lock(mutex_);
        if (!was_offered_.wait(lock, stop, [this] { return offered_.has_value(); }))
            return std::nullopt;
        Begun begun{*std::exchange(offered_, std::nullopt), std::nullopt};
        // what a free second stage was given is as good as begun there
        if (made_ && !is_second_free_) {
            begun.dropped = std::exchange(made_, std::nullopt);
            ++num_dropped_;
        }
        return begun;
    }

    /// First stage: what was begun is ready for the second. Replaces what a free second stage was
    /// given and has not come to take meanwhile.
    void hand_over(Made value) {
        {
            const std::lock_guard lock(mutex_);
            if (made_) ++num_dropped_;
            made_ = std::move(value);
        }
        was_made_.notify_one();
    }

    /// Second stage: is free, and waits for a value; nullopt once a stop is requested.
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
