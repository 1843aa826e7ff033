#pragma once

#include "tools/calibrate/board/solve_board.hpp"
#include "tools/calibrate/wand/judge_wand.hpp"

namespace atrium::calibrate {

/// Says what a calibration with boards is worth, and what is wrong with it. `rate_hz`: of the
/// instants.
Verdict judge_board(const BoardSolution& solution, double rate_hz);

/// Two cameras that show the board at the same pixels, as one sentence with the cure; empty if
/// there are none.
std::string same_board_pictures(const BoardPoints& points);

}  // namespace atrium::calibrate
