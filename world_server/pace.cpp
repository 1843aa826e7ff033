#include "world_server/pace.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::world_server {

Pace::Pace(std::chrono::nanoseconds tick, int max_catch_up, Clock::time_point start)
    : tick_(tick), max_catch_up_(max_catch_up), next_(start + tick) {
    assert(tick.count() > 0 && max_catch_up > 0);
}

int Pace::num_due(Clock::time_point now) {
    if (now < next_) return 0;
    const std::int64_t num_passed = (now - next_) / tick_ + 1;
    next_ += num_passed * tick_;
    const std::int64_t num_due = std::min<std::int64_t>(num_passed, max_catch_up_);
    num_skipped_ += static_cast<std::uint64_t>(num_passed - num_due);
    return static_cast<int>(num_due);
}

void sleep_until(Pace::Clock::time_point time, std::stop_token stop) {
    std::mutex mutex;
    std::condition_variable_any nothing;
    std::unique_lock lock(mutex);
    nothing.wait_until(lock, stop, time, [] { return false; });
}

}  // namespace atrium::world_server
