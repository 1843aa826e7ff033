#include "tools/calibrate/conclude_heights.hpp"

#include "tools/calibrate/judge/angles.hpp"
#include "tools/calibrate/up_text.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

// Heights that differ by more than this contradict each other.
constexpr double kAgree_m = 0.05;
// What the pictures' horizon may be wrong by, beyond its own scatter.
constexpr double kLeastGuess_deg = 3.0;
constexpr double kNoGuess_deg = 30.0;
constexpr double kGuessFactor = 1.5;
// The heights contradict the pictures if their directions differ by this times the error.
constexpr double kFarFromGuess = 2.0;

class HeightsConcluder {
public:
    HeightsConcluder(const RigBefore& rig, const Measurements& measured)
        : rig_(rig), measured_(measured) {
        for (const auto& camera : rig.cameras) centres_.push_back(camera.centre_site());
        std::vector<std::string> names;
        for (const MeasuredHeight& height : measured.heights)
            names.push_back(rig.cameras[height.camera].name);
        names_ = enumerated(names);
    }

    void run(UpConclusion& result);

private:
    void keep_up(UpConclusion& result, const HeightFit& level) const;
    void turn_up(UpConclusion& result, const HeightFit& fit) const;
    void report_one_tilt(UpConclusion& result, const HeightFit& fit) const;
    void report_contradiction(UpConclusion& result, const HeightFit& fit) const;
    std::size_t farthest_from_line(const Eigen::Vector3d& up) const;
    std::string odd_text() const;

    const std::string& name_of(const MeasuredHeight& height) const {
        return rig_.cameras[height.camera].name;
    }

    const RigBefore& rig_;
    const Measurements& measured_;
    std::vector<Eigen::Vector3d> centres_;
    std::string names_;
    UpGuess guess_;
};

void HeightsConcluder::run(UpConclusion& result) {
    guess_.up = result.up        ? *result.up
                : rig_.has_frame ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
                                 : rig_.found.up;
    guess_.error_deg = rig_.found.is_known
                           ? std::max(kLeastGuess_deg, kGuessFactor * rig_.found.error_deg)
                           : kNoGuess_deg;
    const HeightFit level = fit_floor(centres_, measured_.heights, guess_.up);
    const bool is_axis_of_file = rig_.has_frame && result.is_axis;
    if (rig_.is_up_said || (is_axis_of_file && level.deviation_m < kAgree_m)) {
        keep_up(result, level);
    } else {
        turn_up(result, fit_heights(centres_, measured_.heights, guess_));
    }
}

void HeightsConcluder::keep_up(UpConclusion& result, const HeightFit& level) const {
    result.floor_m = level.floor_m;
    if (level.deviation_m < kAgree_m) {
        result.told.push_back(fmt::format("up: the heights of {} agree with it to {:.0f} cm",
                                          names_,
                                          std::max(1.0, std::ceil(100.0 * level.deviation_m))));
        return;
    }
    const HeightFit fit = fit_heights(centres_, measured_.heights, guess_);
    result.checks.push_back(
        fmt::format("up: the heights of {} contradict it by up to {:.2f} m: leave --up out, "
                    "because the heights "
                    "give --up {}; or {}",
                    names_,
                    level.deviation_m,
                    direction_text(fit.up),
                    odd_text()));
}

void HeightsConcluder::turn_up(UpConclusion& result, const HeightFit& fit) const {
    result.up = fit.up;
    result.is_axis = false;
    result.floor_m = fit.floor_m;
    result.told.clear();
    result.checks.clear();
    const double off_deg = degrees_between(fit.up, guess_.up);
    const std::string pictures = rig_.found.is_known
                                     ? fmt::format(
                                           ", {:.1f} degrees from the direction along which the "
                                           "pictures are level",
                                           degrees_between(fit.up, rig_.found.up))
                                     : "";
    if (fit.has_both_tilts) {
        result.told.push_back(
            fmt::format("up: from the heights of {}, good to about {:.1f} "
                        "degrees: --up {}{}",
                        names_,
                        std::max(0.1, fit.error_deg),
                        direction_text(fit.up),
                        pictures));
    } else {
        report_one_tilt(result, fit);
    }
    if (fit.deviation_m > kAgree_m) {
        report_contradiction(result, fit);
    } else if (off_deg > kFarFromGuess * guess_.error_deg) {
        result.checks.push_back(
            fmt::format("up: the heights of {} lean it by {:.0f} degrees against the pictures, "
                        "which is much; {}",
                        names_,
                        off_deg,
                        odd_text()));
    }
}

// Measured cameras on one line leave the tilt about it open.
void HeightsConcluder::report_one_tilt(UpConclusion& result, const HeightFit& fit) const {
    result.told.push_back(fmt::format(
        "up: one tilt from the heights of {}, the other one from the pictures' horizon: --up {}",
        names_,
        direction_text(fit.up)));
    const std::size_t next = farthest_from_line(fit.up);
    const bool is_measured = std::ranges::find(measured_.heights, next, &MeasuredHeight::camera) !=
                             measured_.heights.end();
    result.checks.push_back(fmt::format(
        "up: {}the tilt about the line through {} is taken from the pictures, good to about {:.0f} "
        "degrees: {}",
        measured_.heights.size() > 2 ? "seen from above, these cameras stand on about one line; "
                                     : "",
        names_,
        std::ceil(fit.error_deg),
        is_measured ? "measure how high a camera beside that line hangs, if there is one"
                    : fmt::format("measure the height of a camera beside it as well: "
                                  "--camera-height {} METRES",
                                  rig_.cameras[next].name)));
}

void HeightsConcluder::report_contradiction(UpConclusion& result, const HeightFit& fit) const {
    std::string other_distance;
    if (measured_.distance) {
        const auto scale = scale_of_heights(centres_, measured_.heights, fit.up);
        const auto& [from, to, metres] = *measured_.distance;
        other_distance = scale ? fmt::format(
                                     "; or the distance from {0} to {1}: with --distance {0} {1} "
                                     "{2:.2f} the heights would agree",
                                     from,
                                     to,
                                     metres * *scale)
                               : fmt::format("; or the distance from {} to {}", from, to);
    }
    result.problems.push_back(
        fmt::format("up: the heights of {} contradict each other{} by up to {:.2f} m; {}{}",
                    names_,
                    measured_.distance ? " or --distance" : "",
                    fit.deviation_m,
                    odd_text(),
                    other_distance));
}

// The cure of heights that contradict something.
std::string HeightsConcluder::odd_text() const {
    const auto odd = odd_height(centres_, measured_.heights, guess_);
    if (!odd) return "measure the heights again, from the floor to the lens";
    const MeasuredHeight& height = measured_.heights[odd->index];
    return fmt::format("measure {} {}: you say {} m, by the others it is {:.2f} m",
                       odd->is_clear ? "again that of" : "them again, first that of",
                       name_of(height),
                       height.metres,
                       odd->others_say_m);
}

// Seen from above, from the line through the two measured cameras that are farthest apart.
std::size_t HeightsConcluder::farthest_from_line(const Eigen::Vector3d& up) const {
    const auto flat = [&](std::size_t i) {
        return Eigen::Vector3d(centres_[i] - centres_[i].dot(up) * up);
    };
    Eigen::Vector3d start = flat(measured_.heights.front().camera);
    Eigen::Vector3d along = Eigen::Vector3d::Zero();
    for (const MeasuredHeight& height : measured_.heights) {
        const Eigen::Vector3d to = flat(height.camera) - start;
        if (to.norm() > along.norm()) along = to;
    }
    along.normalize();
    std::size_t farthest = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < centres_.size(); ++i) {
        const Eigen::Vector3d to = flat(i) - start;
        const double beside = (to - to.dot(along) * along).norm();
        if (beside <= most) continue;
        farthest = i;
        most = beside;
    }
    return farthest;
}

}  // namespace

void conclude_heights(UpConclusion& result, const RigBefore& rig, const Measurements& measured) {
    HeightsConcluder(rig, measured).run(result);
}

}  // namespace atrium::calibrate
