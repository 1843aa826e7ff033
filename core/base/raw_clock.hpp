#pragma once

#include "core/base/timestamp.hpp"

#include <time.h>

#include <chrono>

namespace atrium {

/// A clock that nobody sets and no time daemon makes faster or slower: that of the hardware.
inline std::chrono::nanoseconds raw_now() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC_RAW, &now);
    return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

/// `settable` minus `steady`, by the shortest of three looks: a thread may lose its core between
/// both clocks.
template <typename Settable, typename Steady>
std::chrono::nanoseconds difference_of_clocks(const Settable& settable, const Steady& steady) {
    std::chrono::nanoseconds best_gap = std::chrono::nanoseconds::max();
    std::chrono::nanoseconds best{};
    for (int look = 0; look < 3; ++look) {
        const std::chrono::nanoseconds before = steady();
        const Timestamp now = settable();
        const std::chrono::nanoseconds after = steady();
        if (after - before >= best_gap) continue;
        best_gap = after - before;
        best = std::chrono::nanoseconds(now.ns) - (before + best_gap / 2);
    }
    return best;
}

/// The host's clock minus `raw_now`.
inline std::chrono::nanoseconds site_minus_raw() {
    return difference_of_clocks(Timestamp::now, raw_now);
}

}  // namespace atrium
