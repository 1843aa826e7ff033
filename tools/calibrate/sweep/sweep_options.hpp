#pragma once

#include "tools/calibrate/sweep/source_options.hpp"

#include <cstddef>
#include <filesystem>

namespace atrium::calibrate {

/// Where the pictures of a sweep come from, and when it is enough: options of `calibrate wand`.
struct SweepOptions {
    SourceOptions source;
    std::size_t num_instants = 300;     // after which a live sweep ends
    std::filesystem::path keep_points;  // empty: beside the rig
    double light_threshold = 0.0;       // DetectionOptions

    /// Adds all of them to the command line; `*this` must outlive it.
    void add_to(CLI::App& command);
};

}  // namespace atrium::calibrate
