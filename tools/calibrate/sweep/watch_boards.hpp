#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/board/board.hpp"
#include "tools/calibrate/board/film_boards.hpp"
#include "tools/calibrate/sweep/board_tally.hpp"
#include "tools/calibrate/sweep/source_options.hpp"

#include <stop_token>
#include <vector>

namespace atrium::calibrate {

/// Watches somebody show boards to live cameras, and says on standard error what each camera still
/// needs (BoardTally). Ends when it is enough, or with the stop. `options` must be resolved. Errors
/// of the source; kInvalidData with the cause if the cameras saw no such boards.
Expected<BoardFilm> watch_boards(const SourceOptions& options,
                                 const std::vector<Board>& boards,
                                 const BoardNeeds& needs,
                                 std::stop_token stop);

/// Waits until the cameras of `rig` have seen a board at rest for some instants, and returns these.
/// Errors as of watch_boards; also if the stop came first.
Expected<BoardFilm> watch_resting_board(const SourceOptions& options,
                                        const std::vector<Board>& boards,
                                        const config::Rig& rig,
                                        std::stop_token stop);

}  // namespace atrium::calibrate
