#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>

namespace atrium::hosts {

/// Measures the clock of another host as NTP does (RFC 5905, section 8): a question leaves here at
/// `asked`, reaches the other host at `received`, is answered there at `answered`, and the answer
/// is here at `returned`. Half of the way's time bounds the error, however unequal both ways are.
/// The answers of the last seconds count together: the shortest way there and the shortest way back
/// bound the error. Not thread-safe.
class HostClock {
public:
    using Time = std::chrono::steady_clock::time_point;

    struct Answer {
        Timestamp asked;     // on this host's clock
        Timestamp received;  // on the other host's clock
        Timestamp answered;
        Timestamp returned;  // on this host's clock
    };
    /// The other clock minus this one, within `error`.
    struct Estimate {
        std::chrono::nanoseconds offset{0};
        std::chrono::nanoseconds error{0};
    };

    /// Both clocks may run this much apart: NTP changes the rate of a clock by up to 500 ppm.
    static constexpr double kMostDrift = 1e-3;
    static constexpr std::size_t kWindow = 32;
    static constexpr std::chrono::seconds kLongestAge{5};

    /// Ignores answers whose times are impossible.
    void add(const Answer& answer, Time now);

    /// Empty without an answer in the last seconds.
    std::optional<Estimate> estimate(Time now) const;

private:
    struct Sample {
        std::chrono::nanoseconds offset;
        std::chrono::nanoseconds error;  // when it was measured
        Time time;
    };
    std::deque<Sample> samples_;
};

}  // namespace atrium::hosts
