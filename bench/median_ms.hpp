#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

namespace atrium::bench {

/// Runs `work` several times. Returns the median of the times [ms]: other programs disturb single
/// runs.
template <typename Work>
double median_ms(std::size_t repetitions, Work&& work) {
    std::vector<double> ms(repetitions);
    for (double& time : ms) {
        const auto begin = std::chrono::steady_clock::now();
        work();
        time = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
                   .count();
    }
    const auto middle = ms.begin() + static_cast<std::ptrdiff_t>(repetitions / 2);
    std::nth_element(ms.begin(), middle, ms.end());
    return *middle;
}

}  // namespace atrium::bench
