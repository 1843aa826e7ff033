#include "viewer/pacing/drawing_times.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::viewer {

void DrawingTimes::add_picture(Duration duration) {
    pictures_.add(duration);
    longest_ = std::max(longest_, duration);
}

void DrawingTimes::add_preparation(Duration duration) {
    longest_preparation_ = std::max(longest_preparation_, duration);
}

void DrawingTimes::add_way(Duration decoding, Duration waiting, Duration to_display) {
    decoding_.add(decoding);
    waiting_.add(waiting);
    to_display_.add(to_display);
}

std::string DrawingTimes::text() const {
    const Quantiles people = people_.quantiles();
    const Quantiles pictures = pictures_.quantiles();
    const Quantiles to_display = to_display_.quantiles();
    return fmt::format(
        "taking_in_ms={:.2f} taking_in_p99_ms={:.2f} picture_ms={:.1f} "
        "longest_preparation_ms={:.1f} "
        "longest_picture_ms={:.1f} decoding_ms={:.1f} waiting_ms={:.1f} "
        "complete_to_display_ms={:.1f} "
        "complete_to_display_p99_ms={:.1f}",
        people.median_ms,
        people.p99_ms,
        pictures.median_ms,
        milliseconds(longest_preparation_),
        milliseconds(longest_),
        decoding_.quantiles().median_ms,
        waiting_.quantiles().median_ms,
        to_display.median_ms,
        to_display.p99_ms);
}

}  // namespace atrium::viewer
