#include "tools/calibrate/board/filmed_camera.hpp"

#include "tools/calibrate/board/recognise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr double kManyContradicting = 0.35;  // of the markers
constexpr std::size_t kEnoughMarkers = 20;   // to judge the board by them
constexpr double kMarkerSideOff = 0.1;

// The markers' width beside that of the squares.
std::string explain_sides(const std::vector<FilmedCamera>& cameras,
                          const std::vector<Board>& boards) {
    std::vector<double> sides;
    for (const FilmedCamera& filmed : cameras)
        sides.insert(sides.end(), filmed.marker_sides.begin(), filmed.marker_sides.end());
    if (sides.size() < kEnoughMarkers || boards.size() > 1) return {};
    const auto middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
    std::ranges::nth_element(sides, middle);
    const double said = boards.front().marker_m / boards.front().square_m;
    if (std::abs(*middle / said - 1.0) < kMarkerSideOff) return {};
    return fmt::format(
        "the markers are {:.2f} of a square wide, and --board says {:.2f}: measure square_m, which "
        "gives the scale of the room, and marker_m again",
        *middle,
        said);
}

}  // namespace

void FilmedCamera::count(const Detection& detection) {
    ++camera.num_pictures;
    num_views += detection.corners.empty() ? 0 : 1;
    num_fitting += detection.fitting.size();
    num_contradicting += detection.contradicting.size();
    marker_sides.insert(
        marker_sides.end(), detection.marker_sides.begin(), detection.marker_sides.end());
}

void FilmedCamera::keep(std::uint32_t instant, const Detection& detection) {
    for (const SeenCorner& corner : detection.corners)
        camera.corners.push_back({instant, corner.corner, corner.px});
}

std::string explain_film(const std::vector<FilmedCamera>& cameras,
                         const std::vector<Board>& boards,
                         std::size_t least_views) {
    std::size_t num_views = 0, num_fitting = 0, num_contradicting = 0;
    std::vector<GrayPicture> samples;
    for (const FilmedCamera& filmed : cameras) {
        num_views += filmed.num_views;
        num_fitting += filmed.num_fitting;
        num_contradicting += filmed.num_contradicting;
        samples.insert(samples.end(), filmed.samples.begin(), filmed.samples.end());
    }
    if (num_views == 0)
        return fmt::format("no picture shows {}: {}",
                           boards.size() == 1 ? boards.front().text() : "one of the boards",
                           recognise(samples, boards));
    const std::size_t num_markers = num_fitting + num_contradicting;
    if (num_markers >= kEnoughMarkers && static_cast<double>(num_contradicting) >
                                             kManyContradicting * static_cast<double>(num_markers))
        return fmt::format("of {} markers in the pictures, {} do not lie as --board says: {}",
                           num_markers,
                           num_contradicting,
                           recognise(samples, boards));
    std::string text;
    for (const FilmedCamera& filmed : cameras) {
        if (filmed.num_views >= least_views) continue;
        if (filmed.camera.num_pictures == 0) {
            text += fmt::format(
                "{}camera '{}' sent no picture", text.empty() ? "" : "; ", filmed.camera.name);
            continue;
        }
        text += fmt::format("{}camera '{}' shows the board in {} of its {} pictures: {}",
                            text.empty() ? "" : "; ",
                            filmed.camera.name,
                            filmed.num_views,
                            filmed.camera.num_pictures,
                            recognise(filmed.samples, boards));
    }
    return text.empty() ? explain_sides(cameras, boards) : text;
}

BoardPoints points_of(std::vector<FilmedCamera> cameras) {
    BoardPoints points;
    for (FilmedCamera& filmed : cameras) {
        std::ranges::sort(filmed.camera.corners, [](const auto& a, const auto& b) {
            return a.instant != b.instant ? a.instant < b.instant : a.corner < b.corner;
        });
        points.push_back(std::move(filmed.camera));
    }
    return points;
}

}  // namespace atrium::calibrate
