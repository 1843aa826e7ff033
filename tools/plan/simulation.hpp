#pragma once

#include "tools/plan/site_plan.hpp"

#include <cstdint>
#include <vector>

namespace atrium::plan {

struct SimulationOptions {
    double seconds = 20.0;
    /// All hosts share these cores, as programs on one computer do; 0: each host has its own.
    int shared_cores = 0;
    /// Standard deviation of the logarithm of a task's time: tasks do not take the same time twice.
    double spread = 0.15;
    std::uint64_t seed = 1;
};

struct SimulationResult {
    double metaframes_per_s = 0.0;  // published
    double dropped = 0.0;           // share of all metaframes
    double median_ms = 0.0;         // from capture to the written mesh
    double p99_ms = 0.0;
    std::vector<double> loads;  // of each host's cores; with shared cores one value
};

/// Plays a plan: each host has a queue of tasks for its cores, oldest metaframe first; pictures and
/// metaframes that wait are replaced by newer ones, as the programs do.
SimulationResult simulate(const SitePlan& plan, const SimulationOptions& options);

}  // namespace atrium::plan
