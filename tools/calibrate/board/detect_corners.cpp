#include "tools/calibrate/board/detect_corners_internal.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace atrium::calibrate {
namespace {

constexpr double kLeastSquare_px = 8.0;
constexpr int kLeastWindow_px = 2, kMostWindow_px = 10;  // half of it
constexpr double kMostMoved = 0.2;                       // of a square, from the predicted place
constexpr double kLeastContrast = 12.0;
constexpr double kFinest_px = 0.005;
constexpr int kMostSteps = 40;

// A corner where a marker says that it is.
struct Predicted {
    Eigen::Vector2d px = Eigen::Vector2d::Zero();
    // a square's side along +X and +Y of the board [px]
    Eigen::Vector2d along_x = Eigen::Vector2d::Zero(), along_y = Eigen::Vector2d::Zero();
    double num = 0.0;
};

Eigen::Vector2d mapped(const cv::Matx33d& homography, const Eigen::Vector2d& point) {
    const cv::Vec3d p = homography * cv::Vec3d(point.x(), point.y(), 1.0);
    return {p[0] / p[2], p[1] / p[2]};
}

void predict(const Board& board, const SeenMarker& marker, std::vector<Predicted>& corners) {
    const auto places = marker_corners_m(board, marker.id);
    std::array<cv::Point2f, 4> from, to;
    for (std::size_t i = 0; i < 4; ++i) {
        from[i] = {static_cast<float>(places[i].x() / board.square_m),
                   static_cast<float>(places[i].y() / board.square_m)};
        to[i] = {static_cast<float>(marker.corners_px[i].x()),
                 static_cast<float>(marker.corners_px[i].y())};
    }
    const cv::Matx33d homography = cv::getPerspectiveTransform(from.data(), to.data());
    const auto square =
        board.square_of_marker(static_cast<std::size_t>(marker.id - board.first_id));
    for (const int dy : {0, 1}) {
        for (const int dx : {0, 1}) {
            const int column = square.x() + dx - 1, row = square.y() + dy - 1;
            if (column < 0 || row < 0 || column >= board.columns - 1 || row >= board.rows - 1)
                continue;
            const auto index = static_cast<std::size_t>(row * (board.columns - 1) + column);
            const Eigen::Vector3d corner_m = board.corner_m(index) / board.square_m;
            const Eigen::Vector2d at = corner_m.head<2>();
            const Eigen::Vector2d px = mapped(homography, at);
            Predicted& corner = corners[index];
            corner.px += px;
            corner.along_x += mapped(homography, at + Eigen::Vector2d(0.5, 0.0)) -
                              mapped(homography, at - Eigen::Vector2d(0.5, 0.0));
            corner.along_y += mapped(homography, at + Eigen::Vector2d(0.0, 0.5)) -
                              mapped(homography, at - Eigen::Vector2d(0.0, 0.5));
            corner.num += 1.0;
        }
    }
}

double sample(const cv::Mat& gray, const Eigen::Vector2d& px) {
    cv::Mat patch;
    cv::getRectSubPix(
        gray, {3, 3}, {static_cast<float>(px.x()), static_cast<float>(px.y())}, patch);
    return cv::mean(patch)[0];
}

// Two dark and two light squares meet here, in the order of the board.
bool is_saddle(const cv::Mat& gray,
               const Eigen::Vector2d& px,
               const Eigen::Vector2d& to_x,
               const Eigen::Vector2d& to_y,
               bool is_right_top_black) {
    const double a = sample(gray, px + to_x + to_y), b = sample(gray, px - to_x - to_y);
    const double c = sample(gray, px + to_x - to_y), d = sample(gray, px - to_x + to_y);
    return is_right_top_black ? std::max(a, b) + kLeastContrast < std::min(c, d)
                              : std::max(c, d) + kLeastContrast < std::min(a, b);
}

// A corner, refined; empty if the picture shows none there.
std::optional<Eigen::Vector2d> refine(const cv::Mat& gray,
                                      const Board& board,
                                      std::size_t index,
                                      const Predicted& predicted) {
    const Eigen::Vector2d x = predicted.along_x, y = predicted.along_y;
    const double area = std::abs(x.x() * y.y() - x.y() * y.x());
    // distances between opposite sides of a square
    const double width = area / std::max({x.norm(), y.norm(), 1e-9});
    if (!(width >= kLeastSquare_px)) return std::nullopt;
    // The window shall not reach the markers beside the corner.
    const double free =
        board.kind == BoardKind::kCharuco ? 0.5 * (1.0 - board.marker_m / board.square_m) : 0.5;
    const int window =
        std::clamp(static_cast<int>(1.2 * free * width), kLeastWindow_px, kMostWindow_px);
    const auto is_inside = [&](const Eigen::Vector2d& px) {
        const double border = window + 2;
        return px.x() >= border && px.y() >= border && px.x() <= gray.cols - 1 - border &&
               px.y() <= gray.rows - 1 - border;
    };
    if (!predicted.px.allFinite() || !is_inside(predicted.px)) return std::nullopt;
    std::vector<cv::Point2f> point{
        {static_cast<float>(predicted.px.x()), static_cast<float>(predicted.px.y())}};
    cv::cornerSubPix(gray,
                     point,
                     {window, window},
                     {-1, -1},
                     {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, kMostSteps, kFinest_px});
    const Eigen::Vector2d px(point[0].x, point[0].y);
    const double moved = (px - predicted.px).norm();
    if (!is_inside(px) || moved > std::max(2.0, kMostMoved * width)) return std::nullopt;
    const auto per_row = static_cast<std::size_t>(board.columns - 1);
    const int column = static_cast<int>(index % per_row), row = static_cast<int>(index / per_row);
    const double reach = std::clamp(0.6 * free, 0.08, 0.25);
    const bool is_black = board.is_black(column + 1, row);  // to the right and up
    if (!is_saddle(gray, px, reach * x, reach * y, is_black)) return std::nullopt;
    return px;
}

}  // namespace

std::vector<SeenMarker> detect_markers(const cv::Mat& gray,
                                       const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
    std::vector<std::vector<cv::Point2f>> quads;
    std::vector<int> ids;
    const auto parameters = cv::aruco::DetectorParameters::create();
    cv::aruco::detectMarkers(gray, dictionary, quads, ids, parameters);
    std::vector<SeenMarker> markers;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        SeenMarker marker;
        marker.id = ids[i];
        for (std::size_t k = 0; k < 4; ++k) marker.corners_px[k] = {quads[i][k].x, quads[i][k].y};
        markers.push_back(marker);
    }
    return markers;
}

std::array<Eigen::Vector2d, 4> marker_corners_m(const Board& board, int id) {
    const auto square = board.square_of_marker(static_cast<std::size_t>(id - board.first_id));
    const double gap = 0.5 * (board.square_m - board.marker_m);
    const double left = board.square_m * square.x() + gap;
    const double top = board.square_m * (board.rows - square.y()) - gap;
    const double side = board.marker_m;
    return {Eigen::Vector2d(left, top),
            Eigen::Vector2d(left + side, top),
            Eigen::Vector2d(left + side, top - side),
            Eigen::Vector2d(left, top - side)};
}

std::vector<SeenCorner> corners_beside(const cv::Mat& gray,
                                       const Board& board,
                                       const std::vector<SeenMarker>& markers) {
    std::vector<Predicted> predicted(board.num_corners());
    for (const SeenMarker& marker : markers) predict(board, marker, predicted);
    std::vector<SeenCorner> corners;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
        if (predicted[i].num == 0.0) continue;
        const double n = predicted[i].num;
        const Predicted mean{
            predicted[i].px / n, predicted[i].along_x / n, predicted[i].along_y / n, n};
        if (const auto px = refine(gray, board, i, mean))
            corners.push_back({static_cast<std::uint32_t>(i), *px});
    }
    return corners;
}

std::vector<SeenCorner> detect_chessboard(const cv::Mat& gray, const Board& board) {
    const int columns = board.columns - 1, rows = board.rows - 1;
    std::vector<cv::Point2f> found;
    if (!cv::checkChessboard(gray, {columns, rows}) ||
        !cv::findChessboardCornersSB(gray, {columns, rows}, found, cv::CALIB_CB_NORMALIZE_IMAGE))
        return {};
    const auto at = [&](int column, int row) {
        const cv::Point2f& p = found[static_cast<std::size_t>(row * columns + column)];
        return Eigen::Vector2d(p.x, p.y);
    };
    const Eigen::Vector2d right = at(columns - 1, 0) - at(0, 0), down = at(0, rows - 1) - at(0, 0);
    // seen from the front, rows run clockwise from columns: pictures have +Y down
    const bool is_mirrored = right.x() * down.y() - right.y() * down.x() < 0.0;
    for (const bool is_turned : {false, true}) {
        std::vector<SeenCorner> corners;
        for (int row = 0; row < rows && corners.size() == static_cast<std::size_t>(row * columns);
             ++row) {
            for (int column = 0; column < columns; ++column) {
                int c = is_mirrored ? columns - 1 - column : column, r = row;
                if (is_turned) c = columns - 1 - c, r = rows - 1 - r;
                const double sign_x = is_mirrored != is_turned ? -1.0 : 1.0;
                const double sign_y = is_turned ? 1.0 : -1.0;
                Predicted predicted;
                predicted.px = at(c, r);
                const int c0 = std::min(c, columns - 2), r0 = std::min(r, rows - 2);
                predicted.along_x = sign_x * (at(c0 + 1, r) - at(c0, r));
                predicted.along_y = sign_y * (at(c, r0 + 1) - at(c, r0));
                const auto index = static_cast<std::size_t>(row * columns + column);
                if (const auto px = refine(gray, board, index, predicted))
                    corners.push_back({static_cast<std::uint32_t>(index), *px});
            }
        }
        if (corners.size() == board.num_corners()) return corners;
    }
    return {};
}

}  // namespace atrium::calibrate
