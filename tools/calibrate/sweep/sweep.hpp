#pragma once

#include "core/config/rig.hpp"
#include "tools/calibrate/adjust/wand.hpp"
#include "tools/calibrate/sweep/sweep_options.hpp"
#include "tools/calibrate/wand/light_points.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <stop_token>
#include <vector>

namespace atrium::calibrate {

/// The lights that cameras saw in a sweep.
struct Sweep {
    std::vector<NominalCamera> cameras;  // names and sizes; no focal lengths
    LightPoints points;
    double rate_hz = 30.0;
};

/// Watches somebody sweep the wand, live or in a recording, and shows on standard error what each
/// camera still needs. `options` must be resolved. A live sweep ends when it is enough, or with the
/// stop; a recording is read to its end. Errors of the source; kInvalidData with causes if
/// hardly anything was seen.
Expected<Sweep> record_sweep(const SweepOptions& options, const Wand& wand, std::stop_token stop);

/// Waits until the cameras of `rig` have seen the wand at rest, at as many places as a floor needs
/// (RestingWand): each is an instant. `options` must be resolved. Errors of the source;
/// kConfiguration if pictures do not tell the lights of this wand apart; kInvalidData if the stop
/// came first.
Expected<LightPoints> watch_resting_wand(const SourceOptions& options,
                                         const Wand& wand,
                                         const config::Rig& rig,
                                         std::stop_token stop);

}  // namespace atrium::calibrate
