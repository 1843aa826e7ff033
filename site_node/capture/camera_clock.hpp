#pragma once

#include "core/base/timestamp.hpp"

#include <cstdint>
#include <limits>
#include <optional>

namespace atrium::capture {

/// Converts times of a camera clock to the site clock.
///
/// Pictures arrive some time after their exposure, never before. The smallest difference between
/// arrival and camera time is therefore the best estimate of the clock offset. The estimate may
/// grow by kMaxDrift, for clocks that drift apart; a picture that arrives late on a busy machine
/// keeps its true time distance to its neighbours. The constant latency of the camera stays in the
/// result. All this happens on a clock that nobody sets or slews; the result is on the site's clock
/// as it is now. Not thread-safe.
class CameraClock {
public:
    /// Largest drift between two quartz clocks.
    static constexpr double kMaxDrift = 200e-6;
    /// A larger error means a clock that was reset, or that does not count nanoseconds.
    static constexpr std::int64_t kMaxError_ns = 1'000'000'000;
    /// A larger change of the site's clock between two pictures means that it was set. It may have
    /// been set between a picture's arrival and this call, so that picture teaches nothing.
    static constexpr std::chrono::microseconds kLeastStep{500};

    /// `device_ns` is the camera time of a picture (0: none). `arrival` is the arrival of its first
    /// packet on the site clock, which is `site_minus_raw` ahead of `raw_now` now.
    Timestamp on_site_clock(std::uint64_t device_ns,
                            Timestamp arrival,
                            std::chrono::nanoseconds site_minus_raw);

private:
    bool started_ = false;
    std::int64_t raw_minus_device_ns_ = 0;
    std::int64_t last_arrival_ns_ = 0;  // on the raw clock
    std::chrono::nanoseconds last_site_minus_raw_{0};
};

/// Rejects pictures older than the previous one, from buffers delivered out of order.
///
/// Accepts a clock that was set back after kMaxRefused rejected pictures in increasing order. Not
/// thread-safe.
class BackwardsGuard {
public:
    static constexpr int kMaxRefused = 5;

    /// Returns false if the picture must be discarded.
    bool accept(std::uint64_t time_ns);

    /// Returns true if `accept` would take it as the next picture.
    bool is_newer(std::uint64_t time_ns) const { return !last_ || time_ns > *last_; }

private:
    std::optional<std::uint64_t> last_;
    std::uint64_t last_refused_ = 0;
    int num_refused_ = 0;  // in a row, each newer than the previous
};

}  // namespace atrium::capture
