#pragma once

#include "core/base/median.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

/// Calibrations with and without a fault: is it found, and named rightly?
namespace atrium::bench {

struct Trial {
    std::vector<std::string> problems;  // all that would keep a rig from being written
    std::vector<std::string> expected;  // one of these must be said; none: a good run
    double seconds = 0.0;
};

inline void print_trials_heading() { fmt::print("fault,runs,refused,named,median seconds\n"); }

/// Runs trials of seeds 1 to `seeds` and prints a row. Standard error tells what a run said that
/// was not expected.
inline void print_trials(const char* name,
                         int seeds,
                         const std::function<Trial(std::uint32_t seed)>& run) {
    int num_refused = 0, num_named = 0;
    std::vector<double> seconds;
    for (int seed = 1; seed <= seeds; ++seed) {
        const Trial trial = run(static_cast<std::uint32_t>(seed));
        seconds.push_back(trial.seconds);
        num_refused += trial.problems.empty() ? 0 : 1;
        bool is_named = false;
        for (const std::string& problem : trial.problems)
            for (const std::string& expected : trial.expected)
                is_named = is_named || problem.find(expected) != std::string::npos;
        num_named += is_named ? 1 : 0;
        if (is_named) continue;
        for (const std::string& problem : trial.problems)
            fmt::print(stderr, "{}, seed {}: {}\n", name, seed, problem);
        if (!trial.expected.empty() && trial.problems.empty())
            fmt::print(stderr, "{}, seed {}: not found: {}\n", name, seed, trial.expected.front());
    }
    fmt::print("{},{},{},{},{:.2f}\n", name, seeds, num_refused, num_named, median_of(seconds));
    std::fflush(stdout);
}

/// Calls `work` and returns how long it took [s].
template <typename Work>
double seconds_of(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace atrium::bench
