#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/report/previous_rig.hpp"
#include "tools/calibrate/wand/judge_wand.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace atrium::calibrate {

/// What becomes of a calibration.
struct FinishOptions {
    std::string command;  // for example "calibrate wand"
    std::string source;   // what was calibrated from
    std::string body;     // what was seen, for sentences: "the wand"
    std::filesystem::path output;
    std::filesystem::path frame_of;  // rig whose frame shall be kept; empty: that of the output
    std::filesystem::path report;    // the page; empty: calibration.html beside the output
    bool force = false;              // write in spite of problems and of a rig that is still true
    /// Camera towards which people look: +X of the room. Empty: the frame's own, or the first
    /// camera.
    std::string front;
    Said said;
};

/// Gives solved cameras the frame of the room: that of `previous` if most of its cameras stand
/// where they did and the user does not say up or heights, else as `conclude` finds it. Compares
/// both rigs, prints the verdict, writes the report, and writes the rig unless there are problems.
/// A rig that it replaces is kept beside it; one that is still true stays. Errors kInvalidData if
/// nothing was written because of problems.
Expected<void> finish_calibration(const WandSolution& solution,
                                  Verdict verdict,
                                  const std::optional<PreviousRig>& previous,
                                  const FinishOptions& options);

}  // namespace atrium::calibrate
