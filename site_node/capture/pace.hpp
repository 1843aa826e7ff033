#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace atrium::capture {

/// Keeps a replayed source at its rate. A delay of more than one period starts a new schedule
/// instead of a burst.
class Pace {
public:
    using Clock = std::chrono::steady_clock;

    explicit Pace(std::chrono::nanoseconds period) : period_(period) {}

    /// Waits for the next tick. Returns false once a stop is requested.
    bool wait(std::stop_token stop) { return wait(stop, period_); }

    /// Like above, but the tick is due `after` the previous one.
    bool wait(std::stop_token stop, std::chrono::nanoseconds after) {
        const auto now = Clock::now();
        next_ = started_ ? next_ + after : now;
        started_ = true;
        if (now > next_ + period_) next_ = now;
        std::unique_lock lock(mutex_);
        wake_.wait_until(lock, stop, next_, [] { return false; });
        return !stop.stop_requested();
    }

    /// Due time of the last tick.
    Clock::time_point due() const { return next_; }
    /// Like `due`, on the clock of the stamps. A thread that wakes late still stamps pictures with
    /// their planned time, one period apart.
    Timestamp due_time() const { return Timestamp::now() + (next_ - Clock::now()); }

private:
    std::chrono::nanoseconds period_;
    bool started_ = false;
    Clock::time_point next_{};
    std::mutex mutex_;
    std::condition_variable_any wake_;
};

}  // namespace atrium::capture
