#pragma once

#include "core/base/raw_clock.hpp"
#include "core/base/timestamp.hpp"
#include "site_node/hosts/host_clock.hpp"

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
    /// The settable clock and one that nobody sets or slews; tests have their own.
    struct Clocks {
        std::function<Timestamp()> settable = [] { return Timestamp::now(); };
        std::function<std::chrono::nanoseconds()> steady = raw_now;
    };

    /// A clock whose daemon makes it at most this much faster or slower is not set: NTP changes the
    /// rate by up to 0.05 %, and quartzes differ by some 0.01 %. A daemon that slews it faster
    /// begins an epoch whenever the clock is kLeastStep away from what this rate allows.
    static constexpr double kMostRate = HostClock::kMostDrift;
    static constexpr std::chrono::microseconds kLeastStep{800};

    ClockEpoch() : ClockEpoch(Clocks()) {}
    explicit ClockEpoch(Clocks clocks);

    /// Returns the number of the epoch: random, so that it differs between processes, too.
    std::uint64_t current();

    /// By how much the clock was set last; 0: not yet.
    std::chrono::nanoseconds last_step() const;

private:
    Clocks clocks_;
    mutable std::mutex mutex_;
    std::chrono::nanoseconds followed_;   // difference of both clocks, with kMostRate at most
    std::chrono::nanoseconds last_look_;  // on the steady clock
    std::chrono::nanoseconds last_step_{0};
    std::uint64_t number_;
};

}  // namespace atrium::hosts
