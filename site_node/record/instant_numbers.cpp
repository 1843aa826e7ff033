#include "site_node/record/instant_numbers.hpp"

#include <utility>

namespace atrium::record {
namespace {

// A camera that is later than this many instants gets a number of its own.
constexpr std::size_t kMostRecent = 16;
// A time further ahead is no next instant, but another clock.
constexpr std::chrono::seconds kFarAhead{2};

}  // namespace

InstantNumbers::InstantNumbers(std::size_t num_cameras, std::chrono::nanoseconds period)
    : period_(period), last_(num_cameras) {}

InstantNumbers::Instant& InstantNumbers::open(Timestamp time, Clock::time_point arrival) {
    if (!recent_.empty() && time < recent_.back().time) step_back_ = recent_.back().time - time;
    if (recent_.size() == kMostRecent) recent_.pop_front();
    return recent_.emplace_back(Instant{next_++, time, arrival});
}

InstantNumbers::Instant* InstantNumbers::nearest(const std::optional<std::uint64_t>& after,
                                                 Timestamp time) {
    Instant* best = nullptr;
    for (Instant& instant : recent_) {
        if (after && instant.number <= *after) continue;
        const auto apart = std::chrono::abs(time - instant.time);
        if (2 * apart < period_ && (best == nullptr || apart < std::chrono::abs(time - best->time)))
            best = &instant;
    }
    return best;
}

std::uint64_t InstantNumbers::number(std::size_t camera,
                                     Timestamp capture_time,
                                     Clock::time_point arrival) {
    std::optional<std::uint64_t>& last = last_[camera];
    Instant* found = nearest(last, capture_time);
    if (found == nullptr && !recent_.empty()) {
        Instant& newest = recent_.back();
        const auto ahead = capture_time - newest.time;
        const bool is_next = ahead.count() > 0 && ahead < kFarAhead;
        // a clock of its own: then only the arrival tells the instant
        if (!is_next && arrival - newest.opened < period_ && (!last || *last < newest.number))
            found = &newest;
    }
    if (found == nullptr) found = &open(capture_time, arrival);
    last = found->number;
    return found->number;
}

void InstantNumbers::note_lost(Timestamp capture_time, Clock::time_point arrival) {
    const bool is_newest = recent_.empty() || capture_time > recent_.back().time;
    if (is_newest && nearest(std::nullopt, capture_time) == nullptr) open(capture_time, arrival);
}

std::optional<std::chrono::nanoseconds> InstantNumbers::take_step_back() {
    return std::exchange(step_back_, std::nullopt);
}

}  // namespace atrium::record
