#pragma once

#include "core/base/timestamp.hpp"

#include <cstdint>
#include <limits>
#include <optional>

namespace atrium::capture {

/// Puts times of a camera's clock onto the site's clock.
///
/// Pictures arrive some time after they were taken, never before: the least difference between
/// arrival and the camera's time is the best guess of how the clocks lie. The guess may grow by
/// kMaxDrift, for clocks that run apart, so that a picture that arrives late (a busy machine) keeps
/// its true distance in time to its neighbours. The constant latency of the camera stays in the
/// result. Not thread-safe.
class CameraClock {
public:
    /// Most that two quartz clocks run apart.
    static constexpr double kMaxDrift = 200e-6;
    /// Who is off by more was set anew, or counts in something other than nanoseconds.
    static constexpr std::int64_t kMaxError_ns = 1'000'000'000;

    /// `device_ns` is the camera's time of a picture (0: it has none), `arrival` when its first
    /// packet came.
    Timestamp on_site_clock(std::uint64_t device_ns, Timestamp arrival);

private:
    bool started_ = false;
    std::int64_t site_minus_device_ns_ = 0;
    Timestamp last_arrival_;
};

/// Refuses pictures that are older than those before: buffers that were handed out of order.
///
/// A clock that was set back is believed once kMaxRefused pictures in a row agree with each other.
/// Not thread-safe.
class BackwardsGuard {
public:
    static constexpr int kMaxRefused = 5;

    /// False: the picture is to be thrown away.
    bool accept(std::uint64_t time_ns);

    /// True where it would be accepted as the next one.
    bool is_newer(std::uint64_t time_ns) const { return !last_ || time_ns > *last_; }

private:
    std::optional<std::uint64_t> last_;
    std::uint64_t last_refused_ = 0;
    int num_refused_ = 0;  // in a row, each newer than the one before
};

}  // namespace atrium::capture
