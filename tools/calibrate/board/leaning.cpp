#include "tools/calibrate/board/leaning.hpp"

#include <opencv2/calib3d.hpp>

#include <algorithm>

namespace atrium::calibrate {
namespace {

double leaning_of_one(const Board& board,
                      std::size_t first_corner,
                      const std::vector<SeenCorner>& corners) {
    std::vector<cv::Point2d> from, to;
    for (const SeenCorner& corner : corners) {
        if (corner.corner < first_corner || corner.corner >= first_corner + board.num_corners())
            continue;
        const Eigen::Vector3d place = board.corner_m(corner.corner - first_corner);
        from.emplace_back(place.x() / board.square_m, place.y() / board.square_m);
        to.emplace_back(corner.px.x(), corner.px.y());
    }
    constexpr std::size_t kLeast = 4;
    const cv::Mat homography = from.size() < kLeast ? cv::Mat() : cv::findHomography(from, to);
    if (homography.empty()) return 1.0;
    // the third row is proportional to the depth of a point of the board
    double nearest = 1e9, farthest = -1e9;
    for (const cv::Point2d& p : from) {
        const double depth = homography.at<double>(2, 0) * p.x + homography.at<double>(2, 1) * p.y +
                             homography.at<double>(2, 2);
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    return nearest > 0.0 ? farthest / nearest : 1.0;
}

}  // namespace

double leaning_of(const std::vector<Board>& boards, const std::vector<SeenCorner>& corners) {
    double most = 1.0;
    std::size_t first_corner = 0;
    for (const Board& board : boards) {
        most = std::max(most, leaning_of_one(board, first_corner, corners));
        first_corner += board.num_corners();
    }
    return most;
}

}  // namespace atrium::calibrate
