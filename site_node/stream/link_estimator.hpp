#pragma once

#include "site_node/stream/rate_controller.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

namespace atrium::stream {

/// Report of one viewer about roughly a fifth of a second.
struct LinkReport {
    std::uint32_t num_complete = 0;    // frames
    std::uint32_t num_incomplete = 0;  // frames
    std::uint32_t num_samples = 0;     // 0: the delays are meaningless
    double bit_per_s = 0.0;            // received payload
    // From the write of a sample to its take by the viewer [ms]; the two clocks need not agree.
    double min_delay_ms = 0.0;     // smallest of all samples
    double sure_delay_ms = 0.0;    // lower bound of its part outside the viewer's host
    double longest_wait_ms = 0.0;  // upper bound of a wait in the viewer's host
};

/// Smallest delay of the last 30 s: the delay of the link without a queue. Does not allocate.
class DelayBase {
public:
    void add(double delay_ms, Time now);
    double base_ms() const;
    /// Moves all stored delays after a change of a clock or route.
    void shift(double by_ms);

private:
    static constexpr std::size_t kNumBuckets = 30;
    static constexpr std::chrono::seconds kBucket{1};
    std::array<std::optional<double>, kNumBuckets> smallest_ms_{};
    std::size_t current_ = 0;
    std::optional<Time> bucket_begin_;
};

/// Estimates the capacity of the link to one viewer from its reports.
///
/// Follows the receive-side of Google Congestion Control (Carlucci, De Cicco, Holmer, Mascolo,
/// "Analysis and Design of the Google Congestion Control for Web Real-time Communication", 2016):
/// when a queue builds up, the estimate becomes 0.85 of the arriving rate; without a queue it grows
/// by a few per cent per second and stays within a factor of the arriving rate. Differences:
/// - A queue shows in the smallest delay above the base of the last 30 s, as in LEDBAT (RFC 6817),
///   not in a trend. Smallest of all samples of a report: a lost datagram delays some of them by a
///   round trip, jitter delays each differently, but a queue delays all.
/// - Loss alone changes nothing. Incomplete frames lower the estimate, unless that does not help.
/// - A wait in a viewer that lacks processor time is not a queue in the network. The queue lies
///   between two bounds: the delay that is certainly outside the viewer, and the measured delay. It
///   exists once the lower bound shows it, and is gone once the upper bound shows none. Incomplete
///   frames around a long wait of the viewer are ignored.
/// - A queue is drained at once (`paced_bit_per_s`): the queue itself is the harm.
/// - Well above the rate of the last queue, growth is faster, as in CUBIC (RFC 9438): the link has
///   become faster.
/// - Clocks: a delay that rises faster than time elapses means a clock that was set; a delay that
///   does not fall although little is sent is not our queue. Both move the base.
///
/// Not thread-safe.
class LinkEstimator {
public:
    static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

    /// `first` is the viewer's first report. The site sends `least_bit_per_s` whatever the
    /// estimate: a queue that persists at that rate proves nothing.
    LinkEstimator(const LinkReport& first, double least_bit_per_s, Time now);

    /// `next_bit_per_s`: rate of the stream one step up; 0: there is no step up.
    void add(const LinkReport& report, double next_bit_per_s, Time now);

    /// kNoLimit until the first queue, and again after a long time with room to spare.
    double bit_per_s() const { return estimate_bit_per_s_; }
    /// Rate to send at the moment, at most `bit_per_s`: lower while a queue drains and while a
    /// higher rate is probed on a link that had one.
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
    double mean_bit_per_s_;             // of the arriving rate
    double arrived_bit_per_s_;          // recent maximum of that mean
    double congested_bit_per_s_ = 0.0;  // arriving rate at the last queue; 0: no queue yet
    double queue_ms_ = 0.0;             // lower bound
    double most_queue_ms_ = 0.0;        // upper bound
    double former_queue_ms_ = 0.0;
    Time last_report_;
    std::optional<Time> last_delay_time_;
    double last_delay_ms_ = 0.0;

    // while a queue drains
    bool is_draining_ = false;
    Time drain_since_;
    double drain_from_ms_ = 0.0;
    int num_failed_drains_ = 0;

    // frames of about the last second
    double num_complete_ = 0.0;
    double num_incomplete_ = 0.0;
    double share_before_ = 0.0;  // of incomplete frames, at the last decrease for them
    double tolerated_share_;
    std::optional<Time> lowered_for_frames_;
    std::optional<Time> waited_long_;
};

}  // namespace atrium::stream
