#pragma once

#include "tools/calibrate/board/place_rig.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// Why cameras of the bundle have no place, as one sentence each, with the cure: they never show a
/// board together with others, are late, have mirrored pictures, or contradict the others. Empty if
/// all are placed. `instants` are the numbers of the bundle's poses.
std::string explain_unplaced(const Bundle& bundle,
                             const std::vector<BoardView>& views,
                             const std::vector<CameraPair>& pairs,
                             const std::vector<std::uint32_t>& instants);

}  // namespace atrium::calibrate
