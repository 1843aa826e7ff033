#pragma once

#include "tools/calibrate/board/board.hpp"
#include "tools/calibrate/board/detect.hpp"

#include <vector>

namespace atrium::calibrate {

/// How many times as far away the farthest of these corners of one or several boards is than the
/// nearest of the same board, as their picture shows: 1 for a board that faces the camera, or that
/// is too small to tell. What a focal length is found by. The lens is taken as free of distortion.
double leaning_of(const std::vector<Board>& boards, const std::vector<SeenCorner>& corners);

}  // namespace atrium::calibrate
