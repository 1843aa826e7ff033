#pragma once

#include "tools/calibrate/board/detect.hpp"

#include <opencv2/aruco.hpp>

#include <array>
#include <vector>

/// The steps of BoardDetector.
namespace atrium::calibrate {

std::vector<SeenMarker> detect_markers(const cv::Mat& gray,
                                       const cv::Ptr<cv::aruco::Dictionary>& dictionary);

/// Corners of the marker `id` in the board's frame, clockwise from its top left.
std::array<Eigen::Vector2d, 4> marker_corners_m(const Board& board, int id);

/// The corners of the board that lie beside these markers, refined in the picture.
std::vector<SeenCorner> corners_beside(const cv::Mat& gray,
                                       const Board& board,
                                       const std::vector<SeenMarker>& markers);

/// All corners of a chessboard, or none. The black square at the top left gives its direction.
std::vector<SeenCorner> detect_chessboard(const cv::Mat& gray, const Board& board);

}  // namespace atrium::calibrate
