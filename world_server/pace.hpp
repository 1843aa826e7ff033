#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>

namespace atrium::world_server {

/// Computes how many ticks of a real-time simulation are due.
///
/// After a stall, makes up at most `max_catch_up` ticks. Skips and counts the rest. A machine that
/// is too slow thus runs in slow motion and does not fall further behind.
class Pace {
public:
    using Clock = std::chrono::steady_clock;

    Pace(std::chrono::nanoseconds tick, int max_catch_up, Clock::time_point start);

    /// Returns the number of ticks due at `now`: 0 to max_catch_up.
    int num_due(Clock::time_point now);
    Clock::time_point next() const { return next_; }
    std::uint64_t num_skipped() const { return num_skipped_; }

private:
    std::chrono::nanoseconds tick_;
    int max_catch_up_;
    Clock::time_point next_;
    std::uint64_t num_skipped_ = 0;
};

/// Sleeps until `time`, or until a stop is requested.
void sleep_until(Pace::Clock::time_point time, std::stop_token stop);

}  // namespace atrium::world_server
