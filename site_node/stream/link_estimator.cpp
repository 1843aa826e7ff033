#include "site_node/stream/link_estimator.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::stream {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr double kQueue_ms = 30.0;      // longer, twice in a row, is a queue
constexpr double kLongQueue_ms = 80.0;  // longer is a queue at once
constexpr double kEmpty_ms = 12.0;      // shorter is jitter
constexpr double kDecrease = 0.85;      // factor on the arriving rate
constexpr double kGrowthNear = 1.06;    // per second, up to kNear times the rate of the last queue
constexpr double kGrowthFar = 1.35;     // per second, beyond it
constexpr double kNear = 1.1;
// Limits of the estimate as factors on the arriving rate, or on the next step of the ladder: the
// link is untested beyond them.
constexpr double kAboveArrived = 1.25;
constexpr double kAboveArrivedWider = 1.8;  // if more arrives than during the last queue
constexpr double kAboveNext = 1.1;
constexpr double kCertain = 0.5;  // of the rate that arrives without a queue: the link carries it
constexpr double kHeld = 1.05;    // of the arriving rate, while a queue may be building up
// Factors on the arriving rate while a higher one is probed: a step up may double the rate, and an
// excess must show before the queue is long.
constexpr double kProbe = 1.1;
constexpr double kProbeWider = 1.4;
// Factor on the arriving rate: with this much room, and a stream that needs no more, no limit
// remains.
constexpr double kFree = 3.0;
// A report covers only a few frames, sometimes one more or one less.
constexpr Seconds kArrivedMean{0.5};
constexpr Seconds kArrivedMemory{2.0};
constexpr double kDrainTime_ms = 300.0;  // target time to empty a queue
constexpr double kLeastWhileDraining = 0.2;
constexpr Seconds kDrainPatience{1.0};  // for the queue to shrink
constexpr int kMaxFailedDrains = 2;
constexpr double kClockStep_ms = 150.0;  // beyond the elapsed time
// A viewer with waits this long may lose samples itself: the history of a stream is 8 samples
// (qos/profiles.xml).
constexpr double kLongWait_ms = 100.0;
constexpr Seconds kWaitMemory{1.0};
constexpr Seconds kFrameMemory{1.0};
constexpr double kIncompleteShare = 0.2;
constexpr double kFewFrames = 3.0;
constexpr Seconds kToleranceMemory{30.0};

}  // namespace

void DelayBase::add(double delay_ms, Time now) {
    if (!bucket_begin_) bucket_begin_ = now;
    for (std::size_t turned = 0; now - *bucket_begin_ >= kBucket; ++turned) {
        if (turned == kNumBuckets) {
            bucket_begin_ = now;  // after a long silence all of it is outdated
            break;
        }
        *bucket_begin_ += kBucket;
        current_ = (current_ + 1) % kNumBuckets;
        smallest_ms_[current_].reset();
    }
    std::optional<double>& smallest = smallest_ms_[current_];
    smallest = std::min(smallest.value_or(delay_ms), delay_ms);
}

double DelayBase::base_ms() const {
    std::optional<double> smallest;
    for (const auto& bucket : smallest_ms_) {
        if (bucket) smallest = std::min(smallest.value_or(*bucket), *bucket);
    }
    return smallest.value_or(0.0);
}

void DelayBase::shift(double by_ms) {
    for (auto& bucket : smallest_ms_) {
        if (bucket) *bucket += by_ms;
    }
}

LinkEstimator::LinkEstimator(const LinkReport& first, double least_bit_per_s, Time now)
    : least_bit_per_s_(least_bit_per_s),
      mean_bit_per_s_(first.bit_per_s),
      arrived_bit_per_s_(first.bit_per_s),
      last_report_(now),
      tolerated_share_(kIncompleteShare) {
    measure_queue(first, now);
}

double LinkEstimator::paced_bit_per_s() const {
    if (!is_draining_) {
        if (estimate_bit_per_s_ == kNoLimit) return kNoLimit;
        const double gently = std::max((is_wider() ? kProbeWider : kProbe) * arrived_bit_per_s_,
                                       kDecrease * congested_bit_per_s_);
        return std::min(estimate_bit_per_s_, gently);
    }
    const double share = std::max(kDecrease - queue_ms_ / kDrainTime_ms, kLeastWhileDraining);
    return std::min(estimate_bit_per_s_, share * congested_bit_per_s_);
}

void LinkEstimator::measure_queue(const LinkReport& report, Time now) {
    if (report.num_samples == 0) return;
    if (last_delay_time_) {
        const double rise_ms = report.min_delay_ms - last_delay_ms_;
        const double elapsed_ms = 1e3 * Seconds(now - *last_delay_time_).count();
        if (rise_ms > elapsed_ms + kClockStep_ms) base_.shift(rise_ms);
    }
    last_delay_time_ = now;
    last_delay_ms_ = report.min_delay_ms;
    base_.add(report.min_delay_ms, now);
    former_queue_ms_ = queue_ms_;
    most_queue_ms_ = report.min_delay_ms - base_.base_ms();
    queue_ms_ = std::clamp(report.sure_delay_ms - base_.base_ms(), 0.0, most_queue_ms_);
}

// All samples of one report may have lost a datagram by chance, but hardly those of two.
bool LinkEstimator::is_queue() const {
    return queue_ms_ > kLongQueue_ms || (queue_ms_ > kQueue_ms && former_queue_ms_ > kEmpty_ms);
}

// Returns true if a lower rate may help: too many frames stay incomplete, and the previous decrease
// for this reason reduced their number.
bool LinkEstimator::loses_frames(const LinkReport& report, double elapsed_s, Time now) {
    if (report.longest_wait_ms > kLongWait_ms) waited_long_ = now;
    if (waited_long_ && now - *waited_long_ < kWaitMemory) return false;
    const double keep = std::exp(-elapsed_s / kFrameMemory.count());
    num_complete_ = keep * num_complete_ + report.num_complete;
    num_incomplete_ = keep * num_incomplete_ + report.num_incomplete;
    tolerated_share_ += (kIncompleteShare - tolerated_share_) *
                        (1.0 - std::exp(-elapsed_s / kToleranceMemory.count()));
    const double share = num_incomplete_ / std::max(num_complete_ + num_incomplete_, 1.0);
    if (num_incomplete_ < kFewFrames || share <= tolerated_share_) return false;
    if (lowered_for_frames_ && now - *lowered_for_frames_ < 2.0 * kFrameMemory) return false;
    const bool was_useless = lowered_for_frames_ &&
                             now - *lowered_for_frames_ < 5.0 * kFrameMemory &&
                             share > 0.8 * share_before_;
    lowered_for_frames_ = now;
    share_before_ = share;
    if (was_useless) tolerated_share_ = std::min(1.3 * share, 1.0);
    return !was_useless;
}

void LinkEstimator::decrease(const LinkReport& report, Time now) {
    congested_bit_per_s_ = report.bit_per_s;
    estimate_bit_per_s_ = std::min(estimate_bit_per_s_, kDecrease * report.bit_per_s);
    mean_bit_per_s_ = arrived_bit_per_s_ = report.bit_per_s;
    drain_since_ = now;
    drain_from_ms_ = most_queue_ms_;
}

void LinkEstimator::drain(const LinkReport& report, Time now) {
    const bool has_waited = now - drain_since_ >= kDrainPatience;
    if (most_queue_ms_ < kEmpty_ms || (has_waited && queue_ms_ < kEmpty_ms)) {
        is_draining_ = false;  // empty, or no longer certain
        num_failed_drains_ = 0;
        return;
    }
    if (most_queue_ms_ < 0.7 * drain_from_ms_) {  // it shrinks
        drain_since_ = now;
        drain_from_ms_ = most_queue_ms_;
        num_failed_drains_ = 0;
        return;
    }
    if (!has_waited) return;
    const bool could_be_sent_less = paced_bit_per_s() >= least_bit_per_s_;
    if (!could_be_sent_less || ++num_failed_drains_ < kMaxFailedDrains)
        return decrease(report, now);
    // little was sent and nothing changed: not our queue, but a new route or clock
    base_.shift(most_queue_ms_);
    queue_ms_ = most_queue_ms_ = 0.0;
    is_draining_ = false;
    num_failed_drains_ = 0;
    estimate_bit_per_s_ = kNoLimit;
}

// Returns true if the link is faster than during the last queue.
bool LinkEstimator::is_wider() const { return arrived_bit_per_s_ > kNear * congested_bit_per_s_; }

// Limits growth while a queue may be building up.
void LinkEstimator::hold() {
    estimate_bit_per_s_ =
        std::min(estimate_bit_per_s_, std::max(kHeld * arrived_bit_per_s_, congested_bit_per_s_));
}

void LinkEstimator::grow(double next_bit_per_s, double elapsed_s) {
    estimate_bit_per_s_ = std::max(estimate_bit_per_s_, kCertain * mean_bit_per_s_);
    const bool is_near = estimate_bit_per_s_ < kNear * congested_bit_per_s_;
    const double grown =
        estimate_bit_per_s_ * std::pow(is_near ? kGrowthNear : kGrowthFar, elapsed_s);
    if (next_bit_per_s <= 0.0) {  // the stream needs no more
        estimate_bit_per_s_ = grown > kFree * arrived_bit_per_s_ ? kNoLimit : grown;
        return;
    }
    const double above = is_wider() ? kAboveArrivedWider : kAboveArrived;
    const double most = std::max(above * arrived_bit_per_s_, kAboveNext * next_bit_per_s);
    estimate_bit_per_s_ = std::max(estimate_bit_per_s_, std::min(grown, most));
}

void LinkEstimator::add(const LinkReport& report, double next_bit_per_s, Time now) {
    const double elapsed_s = std::min(Seconds(now - last_report_).count(), 1.0);
    last_report_ = now;
    if (report.num_samples == 0 && report.num_incomplete == 0) return;
    measure_queue(report, now);
    mean_bit_per_s_ +=
        (report.bit_per_s - mean_bit_per_s_) * (1.0 - std::exp(-elapsed_s / kArrivedMean.count()));
    arrived_bit_per_s_ = std::max(
        mean_bit_per_s_, arrived_bit_per_s_ * std::exp(-elapsed_s / kArrivedMemory.count()));
    const bool loses = loses_frames(report, elapsed_s, now);
    if (is_draining_) {
        drain(report, now);
    } else if (is_queue()) {
        is_draining_ = true;
        decrease(report, now);
    } else if (loses) {
        decrease(report, now);
    } else if (estimate_bit_per_s_ != kNoLimit) {
        const bool is_building_up = std::min(queue_ms_, former_queue_ms_) > kEmpty_ms;
        is_building_up ? hold() : grow(next_bit_per_s, elapsed_s);
    }
}

}  // namespace atrium::stream
