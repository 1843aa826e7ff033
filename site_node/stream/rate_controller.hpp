#pragma once

#include "site_node/stream/rate_ladder.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::stream {

/// Of a clock that never goes back. The classes here have none of their own: the caller says when.
using Time = std::chrono::steady_clock::time_point;

/// How much may be sent.
struct Cap {
    double bit_per_s = 0.0;  // what the level is chosen for; 0: no limit
    /// What is let out for the moment, not above `bit_per_s`: less while a queue in the network is
    /// to go away. Metaframes are left out for it, the level stays. 0: no limit.
    double paced_bit_per_s = 0.0;
};

/// Chooses how each metaframe is coded, and which ones are left out, so that the stream stays below
/// a cap.
///
/// The level is the best of the ladder whose predicted rate fits the cap. It falls at once when the
/// prediction does not fit any more. It rises after a better one has fitted with a margin for a
/// while, and by half at most where it can; that while doubles each time when a rise turns out to
/// have been one too many.
///
/// Beside the prediction stands a leaky bucket that does not depend on it: over any second no more
/// goes out than the cap and one frame. Not thread-safe.
class RateController {
public:
    /// `rate_hz`: metaframes per second, until it is measured.
    RateController(int jpeg_quality, double rate_hz);

    void set_cap(const Cap& cap) { cap_ = cap; }

    /// A metaframe is there. Returns the index in `ladder` of the level that it is to be coded at;
    /// nothing: it is left out. To be called for each metaframe.
    std::optional<std::size_t> offer(Time now);

    /// What became of the metaframe that was offered last.
    void coded(std::size_t level, const FrameBytes& bytes, Time now);

    const std::vector<Level>& ladder() const { return ladder_; }
    std::size_t level() const { return level_; }
    /// What the stream would have one step up; 0 where there is none.
    double next_bit_per_s() const { return level_ > 0 ? predicted_bit_per_s(level_ - 1) : 0.0; }
    /// What the stream has at a level [bit/s], for the scene as it is.
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
    int num_left_out_ = 0;  // since the last one that was sent
    std::optional<Time> bucket_empty_;

    // of the way up
    std::chrono::duration<double> hold_;
    std::optional<Time> fits_since_;
    std::optional<Time> last_rise_;
};

}  // namespace atrium::stream
