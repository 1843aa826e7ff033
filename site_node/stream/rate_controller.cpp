#include "site_node/stream/rate_controller.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::stream {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr double kFill = 0.95;         // share of the cap to fill after a step down
constexpr double kMarginUp = 1.08;     // margin by which a better level must fit
constexpr double kRise = 1.5;          // largest rise of the rate at once
constexpr Seconds kHold{1.0};          // how long a better level must fit
constexpr Seconds kMaxHold{5.0};       // after failed rises
constexpr Seconds kRiseFailed{4.0};    // a fall within this time after a rise means it failed
constexpr double kRiseForgiven = 0.5;  // factor on the hold after a rise that lasted longer
// How early a frame may go, relative to the bucket: frames vary in timing and size. The bucket
// leaks slower by as much as this adds to one second.
constexpr Seconds kSlack{0.03};

Time::duration ticks(Seconds s) { return std::chrono::duration_cast<Time::duration>(s); }

}  // namespace

RateController::RateController(int jpeg_quality, double rate_hz)
    : ladder_(make_ladder(jpeg_quality)), sizes_(ladder_), period_s_(1.0 / rate_hz), hold_(kHold) {
    assert(rate_hz > 0.0);
}

double RateController::predicted_bit_per_s(std::size_t level) const {
    return 8.0 * sizes_.frame_bytes(level) / (period_s_ * ladder_[level].send_every);
}

std::size_t RateController::first_that_fits(double bit_per_s) const {
    std::size_t level = 0;
    while (level + 1 < ladder_.size() && predicted_bit_per_s(level) > bit_per_s) ++level;
    return level;
}

void RateController::measure_rate(Time now) {
    if (last_offer_) {
        constexpr double kFollow = 0.05;
        const double gap_s = Seconds(now - *last_offer_).count();
        // ignore pauses
        if (gap_s < 1.0) period_s_ += kFollow * (gap_s - period_s_);
        period_s_ = std::max(period_s_, 1e-3);
    }
    last_offer_ = now;
}

void RateController::step_down(Time now) {
    level_ = std::max(level_, first_that_fits(kFill * cap_.bit_per_s));
    if (last_rise_ && now - *last_rise_ < kRiseFailed) {
        hold_ = std::min(2.0 * hold_, kMaxHold);
        last_rise_.reset();
    }
    fits_since_.reset();
}

void RateController::step_up(std::size_t level, Time now) {
    level_ = level;
    last_rise_ = now;
    fits_since_.reset();
}

// Returns the best level that fits, at most one step or a few small ones up.
std::size_t RateController::level_to_rise_to() const {
    if (level_ == 0) return 0;
    const double most =
        std::max(kRise * predicted_bit_per_s(level_), predicted_bit_per_s(level_ - 1));
    return first_that_fits(std::min(cap_.bit_per_s / kMarginUp, most));
}

void RateController::choose_level(Time now) {
    if (last_rise_ && now - *last_rise_ > kRiseFailed) {
        hold_ = std::max(kRiseForgiven * hold_, kHold);
        last_rise_.reset();
    }
    const bool is_capped = cap_.bit_per_s > 0.0;
    if (is_capped && predicted_bit_per_s(level_) > cap_.bit_per_s) return step_down(now);
    const std::size_t better = is_capped ? level_to_rise_to() : 0;
    if (better >= level_) {
        fits_since_.reset();
        return;
    }
    if (!fits_since_) fits_since_ = now;
    if (now - *fits_since_ >= hold_) step_up(better, now);
}

std::optional<std::size_t> RateController::offer(Time now) {
    measure_rate(now);
    choose_level(now);
    const bool is_turn = ++num_skipped_ >= ladder_[level_].send_every;
    const bool is_full =
        cap_.paced_bit_per_s > 0.0 && bucket_empty_ && *bucket_empty_ - now > ticks(kSlack);
    if (!is_turn || is_full) return std::nullopt;
    num_skipped_ = 0;
    return level_;
}

void RateController::coded(std::size_t level, const FrameBytes& bytes, Time now) {
    sizes_.add(level, bytes);
    if (cap_.paced_bit_per_s <= 0.0) {
        bucket_empty_.reset();
        return;
    }
    const double leak_bit_per_s = cap_.paced_bit_per_s / (1.0 + kSlack.count());
    const double bits = 8.0 * static_cast<double>(bytes.fixed + bytes.colour);
    bucket_empty_ =
        std::max(bucket_empty_.value_or(now), now) + ticks(Seconds(bits / leak_bit_per_s));
}

}  // namespace atrium::stream
