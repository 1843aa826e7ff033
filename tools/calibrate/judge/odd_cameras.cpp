#include "tools/calibrate/judge/odd_cameras.hpp"

#include "core/base/median.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::calibrate {
namespace {

using Cameras = std::span<const geometry::CalibratedCamera>;

constexpr std::array<double, 6> kFactors{0.001, 0.01, 0.1, 10.0, 100.0, 1000.0};
// Lengths, and distances to what all look at, differ by this factor at most within one room.
constexpr double kSameRoom = 5.0;
constexpr double kSurelyOtherUnit = 8.0;
// By chance one of 40 directions is so near to a place.
constexpr double kOddLooksWithin_rad = 0.3;
constexpr double kUpright = 0.5;  // cosine

bool is_within(double ratio, double factor) { return ratio < factor && ratio > 1.0 / factor; }

// How well cameras make a room.
struct Fit {
    std::vector<double> off_axis_rad;  // of the place that most look at, off each camera's axis
    double sum_rad = 0.0;
    double unevenness = 0.0;  // largest ratio of a distance to the median, or its inverse
};

double off_axis_of(const geometry::CalibratedCamera& camera, const Eigen::Vector3d& point) {
    const Eigen::Vector3d point_camera = camera.camera_from_site * point;
    return std::atan2(point_camera.head<2>().norm(), point_camera.z());
}

Fit fit_of(Cameras cameras) {
    Fit fit;
    std::vector<geometry::CalibratedCamera> most;
    const std::vector<bool> looks = look_at_one_place(cameras);
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (looks[i]) most.push_back(cameras[i]);
    const Convergence room = measure_convergence(most.empty() ? cameras : Cameras(most));
    for (const auto& camera : cameras) {
        fit.off_axis_rad.push_back(off_axis_of(camera, room.point));
        fit.sum_rad += fit.off_axis_rad.back();
    }
    for (const auto& camera : most) {
        const double ratio = (room.point - camera.centre_site()).norm() / room.median_distance;
        fit.unevenness = std::max({fit.unevenness, ratio, 1.0 / ratio});
    }
    return fit;
}

}  // namespace

std::optional<OddUnit> find_odd_unit(Cameras cameras,
                                     std::span<const ForeignPose> poses,
                                     const Reading& documented,
                                     std::optional<Reading> fixed,
                                     bool are_matrices) {
    const auto fit_with = [&](std::span<const ForeignPose> tried) {
        const Reading reading =
            fixed ? *fixed : choose_reading(cameras, tried, documented, are_matrices).reading;
        std::vector<geometry::CalibratedCamera> read(cameras.begin(), cameras.end());
        for (std::size_t i = 0; i < read.size(); ++i)
            read[i].camera_from_site = camera_from_site(tried[i], reading);
        return fit_of(read);
    };
    std::vector<double> lengths;
    for (const ForeignPose& pose : poses) lengths.push_back(pose.vector.norm());
    const double usual = median_of(lengths);
    const Fit as_written = fit_with(poses);
    const bool is_even = as_written.unevenness < kSurelyOtherUnit;
    std::optional<OddUnit> found;
    Fit best = as_written;
    for (const double factor : kFactors) {
        OddUnit tried{{}, factor};
        std::vector<ForeignPose> changed(poses.begin(), poses.end());
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const double ratio = lengths[i] / usual;
            if (is_within(ratio, kSameRoom) || !is_within(ratio * factor, kSurelyOtherUnit))
                continue;
            tried.cameras.push_back(i);
            changed[i].vector *= factor;
        }
        if (tried.cameras.empty() || 2 * tried.cameras.size() >= poses.size()) continue;
        const Fit fit = fit_with(changed);
        const bool looks = std::ranges::all_of(tried.cameras, [&](std::size_t i) {
            return fit.off_axis_rad[i] < kOddLooksWithin_rad;
        });
        const double allowed_rad =
            found ? best.sum_rad
                  : as_written.sum_rad + (is_even ? -1.0 : 1.0) * kOddLooksWithin_rad;
        if (!looks || fit.unevenness > kSameRoom || fit.sum_rad > allowed_rad) continue;
        best = fit;
        found = std::move(tried);
    }
    return found;
}

std::optional<Reading> find_odd_reading(const geometry::CalibratedCamera& odd,
                                        const ForeignPose& pose,
                                        Cameras others,
                                        const Reading& common) {
    if (others.size() < 3) return std::nullopt;
    const Convergence room = measure_convergence(others);
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    for (const auto& camera : others)
        up -= camera.camera_from_site.rotation.conjugate() * Eigen::Vector3d::UnitY();
    up.normalize();
    // The readings stand in the order of their likelihood.
    for (const Reading& reading : kReadings) {
        if (reading == common) continue;
        geometry::CalibratedCamera camera = odd;
        camera.camera_from_site = camera_from_site(pose, reading);
        const double distance = (camera.camera_from_site * room.point).norm();
        const bool is_upright = -(camera.camera_from_site.rotation * up).y() > kUpright;
        if (off_axis_of(camera, room.point) < kOddLooksWithin_rad && is_upright &&
            is_within(distance / room.median_distance, kSameRoom))
            return reading;
    }
    return std::nullopt;
}

}  // namespace atrium::calibrate
