#pragma once

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace atrium::bench {

/// Processor time of the calling thread [ms], which other programs hardly affect.
inline double thread_ms() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// The value at this fraction of the sorted values; 0 without values.
inline double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

}  // namespace atrium::bench
