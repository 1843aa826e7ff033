#pragma once

#include "tools/calibrate/board/detect.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// What pictures show in which these boards are not found, as the end of a sentence with the cure:
/// markers of another dictionary, an inverted or mirrored board, another number of columns, a
/// chessboard of another size, or nothing that is known.
std::string recognise(const std::vector<GrayPicture>& pictures, const std::vector<Board>& boards);

}  // namespace atrium::calibrate
