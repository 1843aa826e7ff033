#pragma once

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace atrium::bench {

/// How long the calling thread was on a core [ms], so that what else the machine does counts as
/// little as can be.
inline double thread_ms() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// The value below which that share of them lies; 0 of none.
inline double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

}  // namespace atrium::bench
