#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>

namespace atrium::world_server {

/// Says how many ticks of a real-time simulation are due.
///
/// After a stall at most `max_catch_up` ticks are made up; the rest of the lost time is skipped and
/// counted, so that a machine that is too slow runs in slow motion instead of ever further behind.
class Pace {
public:
    using Clock = std::chrono::steady_clock;

    Pace(std::chrono::nanoseconds tick, int max_catch_up, Clock::time_point start);

    /// Ticks due at `now`: 0 .. max_catch_up.
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
