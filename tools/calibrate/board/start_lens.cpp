#include "tools/calibrate/board/start_lens.hpp"

#include "core/base/median.hpp"

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kLeastViews = 3;
constexpr std::size_t kMostViews = 60;
constexpr std::array kScales{0.55, 0.8, 1.2, 1.8};  // of the picture's width
constexpr int kFewIterations = 15, kManyIterations = 40;
constexpr double kRobust_px = 2.0;
constexpr double kWrong_px = 8.0;  // median error that no lens leaves

// f from homographies H of boards' planes to pixels beside the principal point: with columns h1 and
// h2, h1' w h2 = 0 and h1' w h1 = h2' w h2 for w = diag(1/f^2, 1/f^2, 1).
std::optional<double> zhang_focal(const Bundle& bundle,
                                  std::size_t camera,
                                  const std::vector<BoardView>& views) {
    const BundleCamera& seen_by = bundle.cameras[camera];
    double aa = 0.0, ab = 0.0;
    for (const BoardView& view : views) {
        std::vector<cv::Point2d> from, to;
        for (std::size_t s = view.begin; s < view.end; ++s) {
            const Sighting& sighting = bundle.sightings[s];
            const Eigen::Vector3d& corner = bundle.wand.lights_m[sighting.light];
            from.emplace_back(corner.x(), corner.y());
            to.emplace_back((sighting.px.x() - 0.5 * (seen_by.width - 1)) / seen_by.width,
                            (sighting.px.y() - 0.5 * (seen_by.height - 1)) / seen_by.width);
        }
        const cv::Mat found = cv::findHomography(from, to);
        if (found.empty()) continue;
        const cv::Matx33d h = found;
        const double size = std::hypot(std::hypot(h(0, 0), h(1, 0)), std::hypot(h(0, 1), h(1, 1)));
        if (!(size > 0.0)) continue;
        const auto n = [&](int i, int j) { return h(i, j) / size; };
        const std::array<std::array<double, 2>, 2> equations{
            {{n(0, 0) * n(0, 1) + n(1, 0) * n(1, 1), n(2, 0) * n(2, 1)},
             {n(0, 0) * n(0, 0) + n(1, 0) * n(1, 0) - n(0, 1) * n(0, 1) - n(1, 1) * n(1, 1),
              n(2, 0) * n(2, 0) - n(2, 1) * n(2, 1)}}};
        for (const auto& [a, b] : equations) aa += a * a, ab += a * b;
    }
    const double inverse = aa > 0.0 ? -ab / aa : 0.0;
    if (!(inverse > 0.0)) return std::nullopt;
    const double focal = std::sqrt(1.0 / inverse);
    if (!(focal > 0.2 && focal < 10.0)) return std::nullopt;
    return focal * seen_by.width;
}

// The camera alone, with some of its views.
Bundle alone(const Bundle& bundle, std::size_t camera, const std::vector<BoardView>& views) {
    Bundle part;
    part.wand = bundle.wand;
    part.cameras = {bundle.cameras[camera]};
    part.cameras[0].is_placed = true;
    part.cameras[0].pose = {};
    part.wands.resize(views.size());
    for (std::size_t v = 0; v < views.size(); ++v) {
        for (std::size_t s = views[v].begin; s < views[v].end; ++s) {
            Sighting sighting = bundle.sightings[s];
            sighting.camera = 0;
            sighting.instant = static_cast<std::uint32_t>(v);
            sighting.is_used = true;
            part.sightings.push_back(sighting);
        }
    }
    return part;
}

void place_boards_alone(Bundle& part) {
    for (const BoardView& view : views_of(part)) {
        const auto places = find_places(part, view);
        part.wands[view.pose].is_placed = !places.empty();
        if (!places.empty()) part.wands[view.pose].world_from_wand = places[0].camera_from_board;
    }
}

struct Errors {
    double median_px = 1e9, rms_px = 1e9;
};

// The RMS is that of the errors below three times the median's deviation.
Errors errors_of(const Bundle& part) {
    std::vector<double> errors;
    for (const Sighting& sighting : part.sightings) {
        const double error = error_px(part, sighting).norm();
        errors.push_back(std::isfinite(error) ? error : 1e6);
    }
    Errors result;
    result.median_px = median_of(errors);
    double sum = 0.0, num = 1.0;
    for (const double error : errors) {
        if (error > 4.0 * result.median_px) continue;
        sum += error * error;
        num += 2.0;
    }
    result.rms_px = std::sqrt(sum / num);
    return result;
}

}  // namespace

Expected<double> start_lens(Bundle& bundle,
                            std::size_t camera,
                            const std::vector<BoardView>& views,
                            LensFreedom freedom,
                            int num_threads) {
    std::vector<BoardView> own;
    for (const BoardView& view : views)
        if (view.camera == camera) own.push_back(view);
    BundleCamera& solved = bundle.cameras[camera];
    if (own.size() < kLeastViews)
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("camera '{}' shows the board in {} pictures only; show it the "
                        "board in 20 or more, near and far, tilted to all sides",
                        solved.name,
                        own.size()));
    if (own.size() > kMostViews) {
        std::vector<BoardView> some;
        for (std::size_t i = 0; i < kMostViews; ++i)
            some.push_back(own[i * own.size() / kMostViews]);
        own = std::move(some);
    }
    std::vector<double> focals;
    if (const auto focal = zhang_focal(bundle, camera, own)) focals.push_back(*focal);
    for (const double scale : kScales) focals.push_back(scale * solved.width);
    AdjustOptions adjustment;
    adjustment.robust_px = kRobust_px;
    adjustment.num_threads = num_threads;
    adjustment.max_iterations = kFewIterations;
    adjustment.lens = LensFreedom::kRadial;
    Bundle best;
    double least_px = 1e9;
    for (const double focal : focals) {
        Bundle part = alone(bundle, camera, own);
        part.cameras[0].lens = {
            focal, 0.5 * (solved.width - 1), 0.5 * (solved.height - 1), 0, 0, 0, 0, 0};
        place_boards_alone(part);
        if (!adjust(part, adjustment)) continue;
        place_boards_alone(part);  // some leaned the other way
        if (!adjust(part, adjustment)) continue;
        const double median_px = errors_of(part).median_px;
        if (median_px >= 0.98 * least_px) continue;
        least_px = median_px;
        best = std::move(part);
    }
    if (least_px > kWrong_px)
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("camera '{}': no lens explains its {} views of the board (median error "
                        "{:.0f} px): is the board flat, and is it the one that --board describes?",
                        solved.name,
                        own.size(),
                        least_px));
    adjustment.lens = freedom;
    adjustment.max_iterations = kManyIterations;
    if (const auto done = adjust(best, adjustment); !done) return tl::unexpected(done.error());
    solved.lens = best.cameras[0].lens;
    return errors_of(best).rms_px;
}

}  // namespace atrium::calibrate
