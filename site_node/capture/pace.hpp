#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>

namespace atrium::capture {

/// Keeps a replayed source at its rate. A delay of more than one period starts a new schedule
/// instead of a burst.
class Pace {
public:
    using Clock = std::chrono::steady_clock;

    enum class Phase {
        kFree,
        /// Tick n is due n periods after the Unix epoch, by this host's clock: all hosts of a site
        /// count alike.
        kAligned,
    };

    explicit Pace(std::chrono::nanoseconds period, Phase phase = Phase::kFree)
        : period_(period), phase_(phase) {}

    /// Waits for the next tick. Returns false once a stop is requested.
    bool wait(std::stop_token stop) { return wait(stop, period_); }

    /// Like above, but the tick is due `after` the previous one. Aligned ticks ignore `after`.
    bool wait(std::stop_token stop, std::chrono::nanoseconds after) {
        const auto now = Clock::now();
        if (phase_ == Phase::kAligned) {
            align(now);
        } else {
            next_ = started_ ? next_ + after : now;
            if (now > next_ + period_) next_ = now;
        }
        started_ = true;
        std::unique_lock lock(mutex_);
        wake_.wait_until(lock, stop, next_, [] { return false; });
        return !stop.stop_requested();
    }

    /// Due time of the last tick.
    Clock::time_point due() const { return next_; }
    /// Like `due`, on the clock of the stamps. A thread that wakes late still stamps pictures with
    /// their planned time, one period apart.
    Timestamp due_time() const {
        if (phase_ == Phase::kAligned) return {number_ * period_.count()};
        return Timestamp::now() + (next_ - Clock::now());
    }
    /// Number of the last aligned tick.
    std::int64_t number() const { return number_; }

private:
    // After a delay, or if the clock was set, the newest tick is next.
    void align(Clock::time_point now) {
        const std::int64_t now_ns = Timestamp::now().ns;
        const std::int64_t current = now_ns / period_.count();
        ++number_;
        if (!started_ || number_ < current || number_ > current + 2)
            number_ = started_ && number_ < current ? current : current + 1;
        next_ = now + std::chrono::nanoseconds(number_ * period_.count() - now_ns);
    }

    std::chrono::nanoseconds period_;
    Phase phase_;
    bool started_ = false;
    std::int64_t number_ = 0;
    Clock::time_point next_{};
    std::mutex mutex_;
    std::condition_variable_any wake_;
};

}  // namespace atrium::capture
