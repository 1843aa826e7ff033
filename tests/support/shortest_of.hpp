#pragma once

#include <algorithm>
#include <chrono>

namespace atrium::test {

/// The shortest of up to `num_tries` times that `measure` returns. The first time below `bound`
/// ends the tries. For promises about durations, which other programs on the machine can only
/// lengthen.
template <typename Measure>
std::chrono::steady_clock::duration shortest_of(int num_tries,
                                                std::chrono::steady_clock::duration bound,
                                                const Measure& measure) {
    auto shortest = std::chrono::steady_clock::duration::max();
    for (int i = 0; i < num_tries && shortest >= bound; ++i)
        shortest = std::min<std::chrono::steady_clock::duration>(shortest, measure());
    return shortest;
}

}  // namespace atrium::test
