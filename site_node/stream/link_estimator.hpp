#pragma once

#include "site_node/stream/rate_controller.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

namespace atrium::stream {

/// What one viewer tells of a fifth of a second or so.
struct LinkReport {
    std::uint32_t num_complete = 0;    // frames
    std::uint32_t num_incomplete = 0;  // frames
    std::uint32_t num_samples = 0;     // 0: the delays mean nothing
    double bit_per_s = 0.0;            // payload that arrived
    // Times from the writing of a sample until the viewer took it [ms], on two clocks that need not
    // agree.
    double min_delay_ms = 0.0;     // of any sample
    double sure_delay_ms = 0.0;    // of that, what was not a wait in the viewer's host, at least
    double longest_wait_ms = 0.0;  // for which something may have waited there
};

/// Smallest delay of the last 30 s: that of the way without a queue. Allocates nothing.
class DelayBase {
public:
    void add(double delay_ms, Time now);
    double base_ms() const;
    /// The clocks, or the way, are not what they were: all that was known is off by so much.
    void shift(double by_ms);

private:
    static constexpr std::size_t kNumBuckets = 30;
    static constexpr std::chrono::seconds kBucket{1};
    std::array<std::optional<double>, kNumBuckets> smallest_ms_{};
    std::size_t current_ = 0;
    std::optional<Time> bucket_begin_;
};

/// What the way to one viewer carries, from the viewer's reports.
///
/// Follows the receive-side of Google Congestion Control (Carlucci, De Cicco, Holmer, Mascolo,
/// "Analysis and Design of the Google Congestion Control for Web Real-time Communication", 2016):
/// where a queue builds up, the estimate becomes 0.85 of what arrives; where there is none, it
/// grows by a few per cent per second and stays within a factor of what arrives. What differs:
/// - A queue is told by the smallest delay over the base of the last 30 s, as in LEDBAT (RFC 6817),
///   not by a trend. The smallest of all samples of a report, since a lost datagram delays some of
///   them by a round trip and jitter each by something else, but a queue delays all.
/// - Loss by itself lowers nothing. Frames that stay incomplete do, unless that does not help.
/// - Waiting in a viewer that lacks processor time is no queue in the network. The queue lies
///   between two bounds: the part of the delay that the viewer is sure of, and the delay measured.
///   It is believed where the lower bound shows it, and gone where the upper bound shows none.
///   Frames that stay incomplete around a long wait of the viewer count for nothing.
/// - A queue is sent away at once (`paced_bit_per_s`): it is the harm itself.
/// - Well above the rate of the last queue growth is faster, in the manner
///    of CUBIC (RFC 9438): the way has become wider.
/// - Clocks: a delay that rises faster than time goes by is a clock that was set; one that does not
///   fall although little is sent is no queue of ours. Both move the base. Not thread-safe.
class LinkEstimator {
public:
    static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

    /// `first` is the viewer's first report. The site sends `least_bit_per_s` whatever is
    /// estimated: that a queue stays while it does so says nothing.
    LinkEstimator(const LinkReport& first, double least_bit_per_s, Time now);

    /// `next_bit_per_s`: what the stream would have one step up; 0: it has all that it wants.
    void add(const LinkReport& report, double next_bit_per_s, Time now);

    /// kNoLimit until there was a queue, and again once there has been room for long.
    double bit_per_s() const { return estimate_bit_per_s_; }
    /// What to send for the moment, at most `bit_per_s`: less while a queue is to go away, and
    /// while a higher rate is tried on a way that had one.
    double paced_bit_per_s() const;
    double queue_ms() const { return queue_ms_; }

private:
    bool is_queue() const;
    bool is_wider() const;
    void measure_queue(const LinkReport& report, Time now);
    bool loses_frames(const LinkReport& report, double elapsed_s, Time now);
    void decrease(const LinkReport& report, Time now);
    void drain(const LinkReport& report, Time now);
    void hold();
    void grow(double next_bit_per_s, double elapsed_s);

    double least_bit_per_s_;
    DelayBase base_;
    double estimate_bit_per_s_ = kNoLimit;
    double mean_bit_per_s_;             // of what arrives
    double arrived_bit_per_s_;          // the most of that of late
    double congested_bit_per_s_ = 0.0;  // what arrived at the last queue; 0: never was one
    double queue_ms_ = 0.0;             // at least
    double most_queue_ms_ = 0.0;
    double former_queue_ms_ = 0.0;
    Time last_report_;
    std::optional<Time> last_delay_time_;
    double last_delay_ms_ = 0.0;

    // while a queue is sent away
    bool is_draining_ = false;
    Time drain_since_;
    double drain_from_ms_ = 0.0;
    int num_vain_ = 0;

    // frames of the last second or so
    double num_complete_ = 0.0;
    double num_incomplete_ = 0.0;
    double share_before_ = 0.0;  // incomplete, when the estimate was lowered for it the last time
    double tolerated_share_;
    std::optional<Time> lowered_for_frames_;
    std::optional<Time> waited_long_;
};

}  // namespace atrium::stream
