#include "tools/calibrate/board/recognise.hpp"

#include "tools/calibrate/board/detect_corners_internal.hpp"

#include <fmt/format.h>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>

namespace atrium::calibrate {
namespace {

// Smaller dictionaries are the beginnings of these.
constexpr std::array kFamilies{"DICT_4X4_1000",
                               "DICT_5X5_1000",
                               "DICT_6X6_1000",
                               "DICT_7X7_1000",
                               "DICT_ARUCO_ORIGINAL",
                               "DICT_APRILTAG_36h11",
                               "DICT_APRILTAG_25h9",
                               "DICT_APRILTAG_36h10",
                               "DICT_APRILTAG_16h5"};
constexpr std::size_t kMostPictures = 8;
constexpr std::size_t kFewMarkers = 6;  // over all pictures, that may be chance
constexpr int kMostColumns = 20;
constexpr int kRansacTries = 100;  // of a board that is right, half a dozen do

std::string family_of(const std::string& dictionary) {
    for (const char* size : {"4X4", "5X5", "6X6", "7X7"})
        if (dictionary.find(size) != std::string::npos) return fmt::format("DICT_{}_1000", size);
    return dictionary;
}

// The smallest dictionary of the family that has this marker.
std::string smallest_with(const std::string& family, int id) {
    if (!family.ends_with("_1000")) return family;
    for (const int size : {50, 100, 250})
        if (id < size) return family.substr(0, family.size() - 4) + std::to_string(size);
    return family;
}

struct Found {
    std::string family;
    bool is_inverted = false, is_mirrored = false;
    std::vector<std::vector<SeenMarker>> markers;  // per picture
    std::size_t num = 0;
    int most_id = 0;
};

Found look_for(const std::vector<cv::Mat>& pictures,
               const std::string& family,
               bool is_inverted,
               bool is_mirrored) {
    Found found{family, is_inverted, is_mirrored, {}, 0, 0};
    const auto dictionary = cv::aruco::getPredefinedDictionary(*dictionary_number(family));
    for (const cv::Mat& picture : pictures) {
        cv::Mat shown = picture;
        if (is_inverted) {
            cv::Mat inverted;
            cv::bitwise_not(shown, inverted);
            shown = inverted;
        }
        if (is_mirrored) {
            cv::Mat flipped;
            cv::flip(shown, flipped, 1);
            shown = flipped;
        }
        auto markers = detect_markers(shown, dictionary);
        // one alone may be chance
        if (markers.size() < 2) markers.clear();
        for (const SeenMarker& marker : markers) found.most_id = std::max(found.most_id, marker.id);
        found.num += markers.size();
        found.markers.push_back(std::move(markers));
    }
    return found;
}

// How many markers lie as on this board.
std::size_t num_fitting(const Board& board, const Found& found) {
    std::size_t num = 0;
    for (const auto& all : found.markers) {
        std::vector<cv::Point2d> from, to;
        for (const SeenMarker& marker : all) {
            const int index = marker.id - board.first_id;
            if (index < 0 || index >= static_cast<int>(board.num_markers())) continue;
            const auto places = marker_corners_m(board, marker.id);
            for (std::size_t i = 0; i < 4; ++i) {
                from.emplace_back(places[i].x(), places[i].y());
                to.emplace_back(marker.corners_px[i].x(), marker.corners_px[i].y());
            }
        }
        if (from.size() < 12) continue;
        std::vector<std::uint8_t> is_inlier;
        cv::findHomography(from, to, cv::RANSAC, 4.0, is_inlier, kRansacTries, 0.99);
        num += static_cast<std::size_t>(std::ranges::count(is_inlier, 1)) / 4;
    }
    return num;
}

std::string of_charuco(const std::vector<cv::Mat>& pictures, const Board& board) {
    const std::string own = family_of(board.dictionary);
    std::vector<std::string> families{own};
    for (const char* family : kFamilies)
        if (family != own) families.emplace_back(family);
    Found best;
    for (const bool is_mirrored : {false, true})
        for (const bool is_other : {false, true})
            for (const std::string& family : families) {
                // the more bits, the less chance; one that was looked for before wins
                Found found =
                    look_for(pictures, family, board.is_inverted != is_other, is_mirrored);
                if (found.num > 2 * best.num) best = std::move(found);
                if (best.num > kFewMarkers * pictures.size()) break;
            }
    if (best.num < kFewMarkers)
        return "the pictures show no markers of any known dictionary: is the board in them, large "
               "enough, sharp and lit?";
    const std::string dictionary = smallest_with(best.family, best.most_id);
    if (best.is_mirrored)
        return fmt::format(
            "the pictures are mirrored: turn mirroring off in the camera's settings, "
            "and record again{}",
            best.family == own ? "" : "; their markers are of " + dictionary);
    if (best.family != own)
        return fmt::format(
            "the pictures show markers of dictionary {}, up to number {}, and --board "
            "says {}",
            dictionary,
            best.most_id,
            board.dictionary);
    if (best.is_inverted != board.is_inverted)
        return fmt::format("the board in the pictures is {}: write inverted = {} into --board",
                           board.is_inverted ? "not inverted"
                                             : "inverted, white where others are "
                                               "black",
                           !board.is_inverted);
    if (best.most_id >= board.first_id + static_cast<int>(board.num_markers()) &&
        static_cast<std::size_t>(best.most_id) >= dictionary_size(board.dictionary))
        return fmt::format(
            "the pictures show markers up to number {}, which {} does not have: write "
            "dictionary = \"{}\" into --board",
            best.most_id,
            board.dictionary,
            dictionary);
    Board shape = board;
    std::size_t most = num_fitting(board, best);
    int least_id = best.most_id;
    for (const auto& markers : best.markers)
        for (const SeenMarker& marker : markers) least_id = std::min(least_id, marker.id);
    for (const int first_id : {board.first_id, least_id, 0}) {
        for (int columns = 3; columns <= kMostColumns; ++columns) {
            for (const bool is_legacy : {false, true}) {
                Board tried = board;
                tried.columns = columns;
                tried.first_id = first_id;
                tried.rows = std::max(3, (2 * (best.most_id - first_id + 1)) / columns);
                while (static_cast<int>(tried.num_markers()) <= best.most_id - first_id)
                    ++tried.rows;
                tried.is_legacy = is_legacy;
                if (is_legacy && tried.rows % 2 != 0) ++tried.rows;
                const std::size_t num = num_fitting(tried, best);
                if (4 * num <= 5 * most) continue;
                most = num;
                shape = tried;
            }
        }
    }
    if (shape.columns != board.columns)
        return fmt::format(
            "its markers lie as on a board of {} columns and {} rows or more, and "
            "--board says {} columns and {} rows: are they swapped?",
            shape.columns,
            shape.rows,
            board.columns,
            board.rows);
    if (shape.first_id != board.first_id)
        return fmt::format("its markers count from about {}, and --board says first_id = {}",
                           shape.first_id,
                           board.first_id);
    if (shape.is_legacy != board.is_legacy)
        return fmt::format("the square at its top left is {}: write legacy = {} into --board",
                           shape.is_legacy ? "white" : "black",
                           shape.is_legacy);
    return fmt::format(
        "{} of its markers are found, but too few corners of squares: is it sharp "
        "and flat, and are square_m and marker_m those of this board?",
        best.num);
}

std::string of_chessboard(const std::vector<cv::Mat>& pictures, const Board& board) {
    const auto num_with = [&](int columns, int rows) {
        return std::ranges::count_if(pictures, [&](const cv::Mat& picture) {
            std::vector<cv::Point2f> found;
            return columns >= 3 && rows >= 3 &&
                   cv::findChessboardCornersSB(picture, {columns - 1, rows - 1}, found);
        });
    };
    constexpr std::array<std::array<int, 2>, 5> kOther{{{1, 1}, {-1, -1}, {0, 1}, {1, 0}, {0, -1}}};
    for (const auto& [more_columns, more_rows] : kOther) {
        const int columns = board.columns + more_columns, rows = board.rows + more_rows;
        if (num_with(columns, rows) > 0)
            return fmt::format(
                "the pictures show a chessboard of {} columns and {} rows of "
                "squares, and --board says {} and {}{}",
                columns,
                rows,
                board.columns,
                board.rows,
                more_columns == 1 && more_rows == 1
                    ? ": count squares, not the corners between them"
                    : "");
    }
    Board charuco;
    const std::string markers = of_charuco(pictures, charuco);
    if (markers.find("no markers") == std::string::npos)
        return "the pictures show a board with markers: write kind = \"charuco\" into --board";
    return "the pictures show no chessboard of about this size: all of its corners must be in the "
           "picture, sharp, with a white border around the board";
}

}  // namespace

std::string recognise(const std::vector<GrayPicture>& pictures, const std::vector<Board>& boards) {
    std::vector<cv::Mat> some;
    const std::size_t num = std::min(pictures.size(), kMostPictures);
    for (std::size_t i = 0; i < num; ++i) {
        const GrayPicture& picture = pictures[i * pictures.size() / num];
        some.push_back(cv::Mat(picture.height,
                               picture.width,
                               CV_8U,
                               const_cast<std::uint8_t*>(picture.pixels.data())));
    }
    return boards.front().kind == BoardKind::kChessboard ? of_chessboard(some, boards.front())
                                                         : of_charuco(some, boards.front());
}

}  // namespace atrium::calibrate
