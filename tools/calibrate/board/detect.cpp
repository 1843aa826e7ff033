#include "tools/calibrate/board/detect.hpp"

#include "tools/calibrate/board/detect_corners_internal.hpp"

#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <set>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr double kFits = 0.15;  // of a marker's side: distance of a marker from its place
constexpr std::size_t kLeastCorners = 6;
constexpr std::size_t kLeastLines = 2;  // rows and columns

double side_px(const SeenMarker& marker) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
        sum += 0.25 * (marker.corners_px[i] - marker.corners_px[(i + 1) % 4]).norm();
    return sum;
}

// Moves the markers that do not lie as the board says to `contradicting`. A lens bends lines, so
// that the plane fits only about.
void keep_fitting(const Board& board, std::vector<SeenMarker>& markers, Detection& detection) {
    if (markers.size() < 2) return;
    std::vector<cv::Point2d> from, to;
    double side = 0.0;
    for (const SeenMarker& marker : markers) {
        const auto places = marker_corners_m(board, marker.id);
        for (std::size_t i = 0; i < 4; ++i) {
            from.emplace_back(places[i].x(), places[i].y());
            to.emplace_back(marker.corners_px[i].x(), marker.corners_px[i].y());
        }
        side = std::max(side, side_px(marker));
    }
    const cv::Mat homography =
        cv::findHomography(from, to, cv::RANSAC, std::max(3.0, kFits * side));
    std::vector<cv::Point2d> projected(from.size());
    if (!homography.empty()) cv::perspectiveTransform(from, projected, homography);
    std::vector<SeenMarker> fitting;
    for (std::size_t m = 0; m < markers.size(); ++m) {
        double off = homography.empty() ? 1e9 : 0.0;
        for (std::size_t i = 4 * m; i < 4 * m + 4; ++i)
            off = std::max(off, cv::norm(projected[i] - to[i]));
        const bool fits = off <= std::max(3.0, kFits * side_px(markers[m]));
        (fits ? fitting : detection.contradicting).push_back(markers[m]);
    }
    markers = std::move(fitting);
}

bool is_enough(const Board& board, const std::vector<SeenCorner>& corners) {
    std::set<int> rows, columns;
    for (const SeenCorner& corner : corners) {
        const int index = static_cast<int>(corner.corner);
        rows.insert(index / (board.columns - 1));
        columns.insert(index % (board.columns - 1));
    }
    return corners.size() >= kLeastCorners && rows.size() >= kLeastLines &&
           columns.size() >= kLeastLines;
}

// How wide the markers are beside the squares, in the plane that the corners give.
void measure_markers(const Board& board,
                     const std::vector<SeenCorner>& corners,
                     const std::vector<SeenMarker>& markers,
                     std::vector<double>& sides) {
    std::vector<cv::Point2d> from, to;
    for (const SeenCorner& corner : corners) {
        const Eigen::Vector3d place = board.corner_m(corner.corner) / board.square_m;
        from.emplace_back(corner.px.x(), corner.px.y());
        to.emplace_back(place.x(), place.y());
    }
    const cv::Mat homography = cv::findHomography(from, to);
    if (homography.empty()) return;
    for (const SeenMarker& marker : markers) {
        std::vector<cv::Point2d> seen, quad(4);
        for (const Eigen::Vector2d& px : marker.corners_px) seen.emplace_back(px.x(), px.y());
        cv::perspectiveTransform(seen, quad, homography);
        sides.push_back(0.25 * (cv::norm(quad[0] - quad[1]) + cv::norm(quad[1] - quad[2]) +
                                cv::norm(quad[2] - quad[3]) + cv::norm(quad[3] - quad[0])));
    }
}

}  // namespace

GrayPicture load_gray(const std::string& file) try {
    const cv::Mat gray = cv::imread(file, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
    if (gray.empty()) return {};
    const cv::Mat whole = gray.isContinuous() ? gray : gray.clone();
    return {whole.cols, whole.rows, {whole.data, whole.data + whole.total()}};
} catch (const cv::Exception&) {
    return {};
}

struct BoardDetector::Search {
    cv::Ptr<cv::aruco::Dictionary> dictionary;  // null: a chessboard
    bool is_inverted = false;
    std::vector<std::size_t> boards;
};

BoardDetector::BoardDetector(std::vector<Board> boards) : boards_(std::move(boards)) {
    std::size_t num_corners = 0;
    for (std::size_t b = 0; b < boards_.size(); ++b) {
        const Board& board = boards_[b];
        first_corner_.push_back(num_corners);
        num_corners += board.num_corners();
        const auto same = std::ranges::find_if(searches_, [&](const Search& search) {
            const Board& other = boards_[search.boards.front()];
            return other.kind == board.kind && other.dictionary == board.dictionary &&
                   other.is_inverted == board.is_inverted;
        });
        if (same != searches_.end()) {
            same->boards.push_back(b);
            continue;
        }
        Search search;
        if (board.kind == BoardKind::kCharuco)
            search.dictionary = cv::aruco::getPredefinedDictionary(
                dictionary_number(board.dictionary).value_or(cv::aruco::DICT_4X4_50));
        search.is_inverted = board.is_inverted;
        search.boards = {b};
        searches_.push_back(std::move(search));
    }
}

BoardDetector::~BoardDetector() = default;

Detection BoardDetector::detect(const GrayPicture& picture) const {
    Detection detection;
    const cv::Mat seen(
        picture.height, picture.width, CV_8U, const_cast<std::uint8_t*>(picture.pixels.data()));
    cv::Mat inverted;
    for (const Search& search : searches_) {
        if (search.is_inverted && inverted.empty()) cv::bitwise_not(seen, inverted);
        const cv::Mat& gray = search.is_inverted ? inverted : seen;
        std::vector<SeenMarker> all;
        if (search.dictionary != nullptr) all = detect_markers(gray, search.dictionary);
        for (const std::size_t b : search.boards) {
            const Board& board = boards_[b];
            std::vector<SeenCorner> corners;
            if (board.kind == BoardKind::kChessboard) {
                corners = detect_chessboard(gray, board);
            } else {
                std::vector<SeenMarker> markers;
                for (SeenMarker& marker : all) {
                    const int index = marker.id - board.first_id;
                    if (index < 0 || index >= static_cast<int>(board.num_markers())) continue;
                    marker.dictionary = b;
                    markers.push_back(marker);
                }
                std::erase_if(all, [&](const SeenMarker& marker) {
                    const int index = marker.id - board.first_id;
                    return index >= 0 && index < static_cast<int>(board.num_markers());
                });
                keep_fitting(board, markers, detection);
                corners = corners_beside(gray, board, markers);
                detection.fitting.insert(detection.fitting.end(), markers.begin(), markers.end());
                if (is_enough(board, corners))
                    measure_markers(board, corners, markers, detection.marker_sides);
            }
            if (!is_enough(board, corners)) continue;
            for (SeenCorner& corner : corners) {
                corner.corner += static_cast<std::uint32_t>(first_corner_[b]);
                detection.corners.push_back(corner);
            }
        }
        // ids that no board has
        detection.contradicting.insert(detection.contradicting.end(), all.begin(), all.end());
    }
    return detection;
}

}  // namespace atrium::calibrate
