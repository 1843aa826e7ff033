#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>

namespace atrium::hosts {

/// Numbers the times between two settings of this host's clock. Times of different epochs cannot be
/// compared: what was measured of the clock before it was set does not hold afterwards.
/// Thread-safe.
class ClockEpoch {
public:
    /// The settable clock and one that nobody sets; tests have their own.
    struct Clocks {
        std::function<Timestamp()> settable = [] { return Timestamp::now(); };
        std::function<std::chrono::nanoseconds()> steady = [] {
            return std::chrono::duration_cast<std::chrono::nanoseconds>(
                std::chrono::steady_clock::now().time_since_epoch());
        };
    };

    /// A clock that runs faster or slower, as NTP makes it (at most 0.05 %), is not set. Calls of
    /// `current` must be less than a second apart to tell both apart.
    static constexpr std::chrono::microseconds kLeastStep{800};

    ClockEpoch() : ClockEpoch(Clocks()) {}
    explicit ClockEpoch(Clocks clocks);

    /// Returns the number of the epoch: random, so that it differs between processes, too.
    std::uint64_t current();

    /// By how much the clock was set last; 0: not yet.
    std::chrono::nanoseconds last_step() const;

private:
    std::chrono::nanoseconds difference() const;

    Clocks clocks_;
    mutable std::mutex mutex_;
    std::chrono::nanoseconds last_difference_;
    std::chrono::nanoseconds last_step_{0};
    std::uint64_t number_;
};

}  // namespace atrium::hosts
