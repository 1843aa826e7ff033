#include "tools/calibrate/board/views.hpp"

#include "core/base/median.hpp"

#include <opencv2/calib3d.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::calibrate {
namespace {

// A second place that fits worse than this is none.
constexpr double kRival_px = 1.0, kRival = 3.0;
constexpr std::size_t kEnoughCorners = 6;  // for a median error

geometry::RigidTransform transform_of(const cv::Mat& turn, const cv::Mat& shift) {
    geometry::RigidTransform transform;
    const Eigen::Vector3d vector(turn.at<double>(0), turn.at<double>(1), turn.at<double>(2));
    if (vector.norm() > 1e-12)
        transform.rotation =
            Eigen::Quaterniond(Eigen::AngleAxisd(vector.norm(), vector.normalized()));
    transform.translation = {shift.at<double>(0), shift.at<double>(1), shift.at<double>(2)};
    return transform;
}

}  // namespace

std::vector<BoardView> views_of(const Bundle& bundle) {
    std::vector<BoardView> views;
    for (std::size_t s = 0; s < bundle.sightings.size(); ++s) {
        const Sighting& sighting = bundle.sightings[s];
        if (views.empty() || views.back().camera != sighting.camera ||
            views.back().pose != sighting.instant)
            views.push_back({sighting.camera, sighting.instant, s, s, {}});
        views.back().end = s + 1;
    }
    return views;
}

std::vector<BoardPlace> find_places(const Bundle& bundle, const BoardView& view) try {
    const BundleCamera& camera = bundle.cameras[view.camera];
    const geometry::PinholeCamera lens = camera.intrinsics();
    std::vector<cv::Point3d> corners;
    std::vector<cv::Point2d> rays;
    for (std::size_t s = view.begin; s < view.end; ++s) {
        const Sighting& sighting = bundle.sightings[s];
        const auto undistorted = lens.undistort(sighting.px);
        if (!undistorted) continue;
        const Eigen::Vector3d ray = lens.ray_camera(*undistorted);
        const Eigen::Vector3d& corner = bundle.wand.lights_m[sighting.light];
        corners.emplace_back(corner.x(), corner.y(), corner.z());
        rays.emplace_back(ray.x(), ray.y());
    }
    if (corners.size() < 4) return {};
    const cv::Mat eye = cv::Mat::eye(3, 3, CV_64F);
    std::vector<cv::Mat> turns, shifts;
    cv::solvePnPGeneric(corners, rays, eye, cv::noArray(), turns, shifts, false, cv::SOLVEPNP_IPPE);
    std::vector<BoardPlace> places;
    for (std::size_t i = 0; i < turns.size(); ++i) {
        cv::solvePnPRefineLM(corners, rays, eye, cv::noArray(), turns[i], shifts[i]);
        BoardPlace place{transform_of(turns[i], shifts[i]), 0.0};
        if (!place.camera_from_board.translation.allFinite()) continue;
        BundleCamera local = camera;
        local.set_camera_from_world(place.camera_from_board);
        double sum = 0.0;
        for (std::size_t s = view.begin; s < view.end; ++s) {
            const Sighting& sighting = bundle.sightings[s];
            sum +=
                (project(local, bundle.wand.lights_m[sighting.light]) - sighting.px).squaredNorm();
        }
        place.rms_px = std::sqrt(sum / (2.0 * static_cast<double>(view.end - view.begin)));
        if (std::isfinite(place.rms_px)) places.push_back(place);
    }
    std::ranges::sort(places, {}, &BoardPlace::rms_px);
    if (places.size() > 1 && places[1].rms_px > kRival_px + kRival * places[0].rms_px)
        places.resize(1);
    return places;
} catch (const cv::Exception&) {
    return {};  // corners that lie nearly on a line
}

double error_of_place(const Bundle& bundle,
                      const BoardView& view,
                      const geometry::RigidTransform& camera_from_board) {
    const BundleCamera& camera = bundle.cameras[view.camera];
    const BundleCamera local{{}, camera.width, camera.height, {}, camera.lens, true};
    std::vector<double> errors;
    const std::size_t step = std::max<std::size_t>(1, (view.end - view.begin) / kEnoughCorners);
    for (std::size_t s = view.begin; s < view.end; s += step) {
        const Sighting& sighting = bundle.sightings[s];
        const Eigen::Vector3d corner_camera =
            camera_from_board * bundle.wand.lights_m[sighting.light];
        const double error = (project(local, corner_camera) - sighting.px).norm();
        errors.push_back(std::isfinite(error) ? error : std::numeric_limits<double>::max());
    }
    return median_of(std::move(errors));
}

}  // namespace atrium::calibrate
