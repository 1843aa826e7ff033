#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace atrium::record {

/// Numbers pictures by their instants: those of all cameras that are less than half a period apart
/// get one number. The numbers of each camera grow, whatever its clock does. Not thread-safe.
class InstantNumbers {
public:
    using Clock = std::chrono::steady_clock;

    InstantNumbers(std::size_t num_cameras, std::chrono::nanoseconds period);

    /// Number of a picture. Arrivals must not decrease.
    std::uint64_t number(std::size_t camera, Timestamp capture_time, Clock::time_point arrival);

    /// Of a picture that its camera lost: the instant gets a number even if all cameras lost it.
    void note_lost(Timestamp capture_time, Clock::time_point arrival);

    /// One more than the largest number given.
    std::uint64_t next() const { return next_; }

    /// By how much the clock of the pictures was set back since the last call; nullopt: it was not.
    std::optional<std::chrono::nanoseconds> take_step_back();

private:
    struct Instant {
        std::uint64_t number = 0;
        Timestamp time;
        Clock::time_point opened;
    };
    Instant& open(Timestamp time, Clock::time_point arrival);
    Instant* nearest(const std::optional<std::uint64_t>& after, Timestamp time);

    std::chrono::nanoseconds period_;
    std::deque<Instant> recent_;                      // the newest one is last
    std::vector<std::optional<std::uint64_t>> last_;  // per camera
    std::uint64_t next_ = 0;
    std::optional<std::chrono::nanoseconds> step_back_;
};

}  // namespace atrium::record
