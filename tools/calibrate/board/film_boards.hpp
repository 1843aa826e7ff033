#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "tools/calibrate/board/board.hpp"
#include "tools/calibrate/board/board_points.hpp"
#include "tools/calibrate/board/detect.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace atrium::calibrate {

struct FilmOptions {
    std::vector<std::string> cameras;  // whose pictures are searched; empty: all, by their folders
    std::size_t most_instants = 300;   // spread evenly over the recording
    std::size_t least_views = 1;       // of each camera; 0: cameras may show no board
    /// Called by one thread at a time with the numbers of pictures, or null.
    std::function<void(std::size_t done, std::size_t all)> progress;
};

/// The boards in the pictures of a recording.
struct BoardFilm {
    BoardPoints points;    // instants count those that were looked at
    std::size_t step = 1;  // pictures from one of these to the next
    double rate_hz = 0.0;  // of these instants, as the videos say; 0: unknown
    std::vector<std::string> checks;
};

/// Looks for boards in all pictures below `folder`: a recording of Atrium, or videos or folders of
/// pictures of cameras as `calibrate import` finds them. Pictures of one number are one instant.
/// Works on `executor`.
///
/// Errors kNotFound, kConfiguration and kInvalidData name the file, or what the pictures show
/// instead of these boards (recognise.hpp): also if only one camera shows none.
Expected<BoardFilm> film_boards(const std::filesystem::path& folder,
                                const std::vector<Board>& boards,
                                const FilmOptions& options,
                                Executor& executor);

}  // namespace atrium::calibrate
