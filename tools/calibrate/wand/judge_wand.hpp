#pragma once

#include "tools/calibrate/wand/solve_wand.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// What a calibration is worth, as sentences for people.
struct Verdict {
    std::vector<std::string> told;      // figures
    std::vector<std::string> checks;    // what could be better, with the cure
    std::vector<std::string> problems;  // the calibration is wrong; the cause and the cure
};

/// Errors of good calibrations [px], of lights that the solution did not use.
inline constexpr double kGood_px = 0.5;

/// `rate_hz`: of the instants.
Verdict judge_wand(const WandSolution& solution, double rate_hz);

/// Two cameras whose points are the same, as one sentence with the cure; empty if there are none.
std::string same_pictures(const LightPoints& points);

}  // namespace atrium::calibrate
