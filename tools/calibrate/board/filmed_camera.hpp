#pragma once

#include "tools/calibrate/board/board.hpp"
#include "tools/calibrate/board/board_points.hpp"
#include "tools/calibrate/board/detect.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// What was found of boards in the pictures of one camera.
struct FilmedCamera {
    BoardCamera camera;
    std::size_t num_views = 0;                           // pictures with corners
    std::size_t num_fitting = 0, num_contradicting = 0;  // markers
    std::vector<double> marker_sides;                    // Detection::marker_sides of all pictures
    std::vector<GrayPicture> samples;                    // some of the pictures

    /// Counts a picture in which this was found.
    void count(const Detection& detection);

    /// Keeps its corners. Instants may come in any order.
    void keep(std::uint32_t instant, const Detection& detection);
};

/// Why these are no pictures of the boards, with the cure: they show none, another board, or
/// markers of another size; or a camera shows the board in fewer than `least_views` pictures. Empty
/// if they are. Looks into the samples for what they show instead (recognise.hpp).
std::string explain_film(const std::vector<FilmedCamera>& cameras,
                         const std::vector<Board>& boards,
                         std::size_t least_views);

/// The corners of all cameras, in order.
BoardPoints points_of(std::vector<FilmedCamera> cameras);

}  // namespace atrium::calibrate
