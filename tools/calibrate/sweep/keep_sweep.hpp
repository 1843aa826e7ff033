#pragma once

#include "tools/calibrate/sweep/sweep.hpp"

namespace atrium::calibrate {

/// Where the points of a sweep are kept: `--keep-points`, else beside the rig that is made.
std::filesystem::path points_file(const SweepOptions& options, const std::filesystem::path& rig);

/// Resolves the options, records the sweep, writes its points into `file` and prints how to solve
/// them again. A file that `--keep-points` names is replaced only with `may_replace`; else the one
/// beside the rig is of a sweep that gave no rig, and is replaced. Errors as of `record_sweep`.
Expected<Sweep> keep_sweep(SweepOptions& options,
                           const Wand& wand,
                           const std::filesystem::path& file,
                           bool may_replace,
                           std::stop_token stop);

}  // namespace atrium::calibrate
