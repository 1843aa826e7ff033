#pragma once

#include "site_node/stream/rate_ladder.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::stream {

/// Monotonic time. The classes here have no clock of their own; the caller passes the time.
using Time = std::chrono::steady_clock::time_point;

/// Limits of the stream.
struct Cap {
    double bit_per_s = 0.0;  // for the choice of the level; 0: no limit
    /// Limit at the moment, at most `bit_per_s`: lower while a queue in the network drains. Skips
    /// metaframes but keeps the level. 0: no limit.
    double paced_bit_per_s = 0.0;
};

/// Chooses how to code each metaframe, and which ones to skip, to keep the stream below a cap.
///
/// The level is the best of the ladder whose predicted rate fits the cap. It falls at once when the
/// prediction no longer fits. It rises after a better level has fitted with a margin for a while,
/// if possible by at most half the rate; the while doubles after each rise that turns out too high.
///
/// A leaky bucket, independent of the prediction, limits the output of any second to the cap plus
/// one frame. Not thread-safe.
class RateController {
public:
    /// `rate_hz`: metaframes per second, until measured.
    RateController(int jpeg_quality, double rate_hz);

    void set_cap(const Cap& cap) { cap_ = cap; }

    /// Call once per metaframe. Returns the index in `ladder` at which to code it; empty: skip it.
    std::optional<std::size_t> offer(Time now);

    /// The metaframe offered last is not sent after all: the next one takes its turn.
    void give_back() { num_skipped_ = ladder_[level_].send_every - 1; }

    /// Reports the size of the metaframe offered last.
    void coded(std::size_t level, const FrameBytes& bytes, Time now);

    const std::vector<Level>& ladder() const { return ladder_; }
    std::size_t level() const { return level_; }
    /// Rate of the stream one step up; 0 if there is no step up.
    double next_bit_per_s() const { return level_ > 0 ? predicted_bit_per_s(level_ - 1) : 0.0; }
    /// Predicted rate of the stream at a level [bit/s], for the current scene.
    double predicted_bit_per_s(std::size_t level) const;

private:
    void measure_rate(Time now);
    void choose_level(Time now);
    void step_down(Time now);
    void step_up(std::size_t level, Time now);
    std::size_t first_that_fits(double bit_per_s) const;
    std::size_t level_to_rise_to() const;

    std::vector<Level> ladder_;
    SizeModel sizes_;
    Cap cap_;
    std::size_t level_ = 0;
    double period_s_;
    std::optional<Time> last_offer_;
    int num_skipped_ = 0;  // since the last metaframe sent
    std::optional<Time> bucket_empty_;

    // state of the rise
    std::chrono::duration<double> hold_;
    std::optional<Time> fits_since_;
    std::optional<Time> last_rise_;
};

}  // namespace atrium::stream
