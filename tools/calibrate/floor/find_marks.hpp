#pragma once

#include "core/config/rig.hpp"
#include "tools/calibrate/adjust/wand.hpp"
#include "tools/calibrate/board/board.hpp"
#include "tools/calibrate/board/board_points.hpp"
#include "tools/calibrate/floor/floor_frame.hpp"
#include "tools/calibrate/wand/light_points.hpp"

#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Marks on the floor as the cameras of a rig saw them.
struct FoundMarks {
    FloorMarks marks;
    std::vector<std::string> told, checks, problems;
};

/// From a board that lies on the floor with its face up. The marks are its origin, +X and +Y, and
/// its corners. `points` are of cameras of the rig. Errors kInvalidData: nobody sees it, it moves,
/// the rig does not fit, or one camera alone sees it in two ways.
Expected<FoundMarks> marks_of_board(const config::Rig& rig,
                                    const std::vector<Board>& boards,
                                    const BoardPoints& points);

/// From lights with numbers: 0 is the origin, 1 lies on +X, 2 on the side of +Y, others anywhere on
/// the floor. With `wand`, the lights are those of a wand that lies there: one on a line at two
/// places or more, whose first one gives origin and +X. Errors kInvalidData: lights that fewer than
/// two cameras see, that move, or that contradict the wand.
Expected<FoundMarks> marks_of_lights(const config::Rig& rig,
                                     const LightPoints& points,
                                     const std::optional<Wand>& wand);

}  // namespace atrium::calibrate
