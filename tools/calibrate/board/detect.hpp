#pragma once

#include "tools/calibrate/board/board.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// A picture of one byte per pixel, row by row.
struct GrayPicture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
};

/// A corner of a board in a picture.
struct SeenCorner {
    std::uint32_t corner = 0;  // of all boards: those of the first board, then the second, ...
    Eigen::Vector2d px;        // distorted
};

/// A marker in a picture.
struct SeenMarker {
    std::size_t dictionary = 0;  // index of the board that names the dictionary
    int id = 0;
    std::array<Eigen::Vector2d, 4> corners_px;  // clockwise from the marker's top left
};

struct Detection {
    std::vector<SeenCorner> corners;  // ascending by corner
    /// Markers of the boards' dictionaries: those that lie as their board says, and others, such as
    /// those of boards that the file describes wrongly.
    std::vector<SeenMarker> fitting, contradicting;
    /// Per marker of a board with corners: its side as a share of that of a square, as seen.
    std::vector<double> marker_sides;
};

/// The picture without colour, by OpenCV. Empty if the file cannot be decoded.
GrayPicture load_gray(const std::string& file);

/// Finds calibration boards in pictures. May be used by several threads.
///
/// Markers are found by OpenCV (Garrido-Jurado et al., 2014). Unlike its ChArUco detector, corners
/// are predicted from each marker beside them, corners of one marker count, the picture must show
/// two dark and two light squares around a corner, and boards may be several.
class BoardDetector {
public:
    explicit BoardDetector(std::vector<Board> boards);
    ~BoardDetector();
    BoardDetector(const BoardDetector&) = delete;
    BoardDetector& operator=(const BoardDetector&) = delete;

    /// Corners of boards that show at least six of them, in two rows and columns or more.
    Detection detect(const GrayPicture& picture) const;

private:
    struct Search;  // of one dictionary
    std::vector<Board> boards_;
    std::vector<std::size_t> first_corner_;  // per board
    std::vector<Search> searches_;
};

}  // namespace atrium::calibrate
