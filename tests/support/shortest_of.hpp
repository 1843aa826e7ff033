#pragma once

#include <algorithm>
#include <chrono>

namespace atrium::test {

/// The shortest of up to `num_tries` times that `measure` returns; the first one below `bound` ends
/// it. For what is promised to happen in time: whatever else runs on the machine only adds to it.
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
