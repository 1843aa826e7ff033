#include "tools/calibrate/concluder.hpp"
#include "tools/calibrate/judge/angles.hpp"
#include "tools/calibrate/judge/odd_cameras.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"
#include "tools/calibrate/up_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kAxesMiss_rad = 0.28;

// Without rotation and translation, but for rounding.
bool is_at_origin(const ForeignPose& pose) {
    return pose.rotation.isIdentity(1e-6) && pose.vector.isZero(1e-6);
}

}  // namespace

void Concluder::read_poses() {
    Reading wanted = foreign_.documented;
    wanted.pose = said_.pose.value_or(wanted.pose);
    wanted.opengl = said_.opengl.value_or(wanted.opengl);
    const bool is_said = said_.pose || said_.opengl;
    const bool is_fixed = is_said || foreign_.is_sure_of_poses;
    if (!foreign_.is_sure_of_poses) unify_units(wanted, is_said);
    ReadingChoice choice = choose_reading(cameras_, poses_, wanted, foreign_.has_matrix_poses);
    const ReadingChoice fitting = choice;
    report_same_poses();
    if (said_.left_handed) tell("poses: left-handed, as you say, and mirrored");
    if (is_fixed) choice = {wanted, {}, true, {}};
    place_cameras(choice.reading);
    const Convergence convergence = measure_convergence(cameras_);
    const std::vector<bool> looks = look_at_one_place(cameras_);
    const auto num_looking = static_cast<std::size_t>(std::ranges::count(looks, true));
    const std::string looking =
        fmt::format("{} of {} cameras look at one place", num_looking, cameras_.size());
    if (is_said || choice.is_documented) {
        tell(fmt::format("poses: {}{}: {}",
                         describe(choice.reading),
                         is_said ? ", as you say" : ", as documented",
                         looking));
    } else {
        place_cameras(wanted);
        const Convergence as_documented = measure_convergence(cameras_);
        place_cameras(choice.reading);
        tell(fmt::format(
            "poses: {}: {}, {:.0f} degrees apart. Read as documented, as {}, {} would "
            "({} to read them so)",
            describe(choice.reading),
            looking,
            2.0 * std::asin(std::sqrt(std::min(1.0, convergence.spread))) * kDegreesPerRad,
            describe(wanted),
            as_documented.num_looking,
            option_of(wanted)));
    }
    if (2 * num_looking < cameras_.size() + 1) {
        problem(fmt::format(
            "poses: only {}: the cameras do not look at one room, or the poses mean "
            "something else; check the calibration, or {}",
            looking,
            is_said ? "leave --direction and --axes out, so that they are found out"
            : fitting.reading == choice.reading ? "say --direction and --axes"
                                                : fmt::format("say {}, with which {} do",
                                                              option_of(fitting.reading),
                                                              fitting.convergence.num_looking)));
        return;
    }
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (!looks[i]) report_elsewhere(i, looks, choice.reading);
        is_frame_of_camera_ = is_frame_of_camera_ || (looks[i] && is_at_origin(poses_[i]));
    }
    if (num_looking == cameras_.size() && convergence.off_axis > kAxesMiss_rad) {
        check(
            fmt::format("poses: the optical axes pass {:.0f} degrees beside the place where they "
                        "come nearest to each other (mean). If all cameras look at one place, {}",
                        convergence.off_axis * kDegreesPerRad,
                        is_said ? "leave --direction and --axes out"
                                : "an angle of theirs may have the wrong sign, such as the pitch"));
    }
    if (!is_said && !choice.also_possible.empty()) {
        check(
            fmt::format("poses: {} would fit the cameras as well; if the person is broken, try {}",
                        describe(choice.also_possible.front()),
                        option_of(choice.also_possible.front())));
    }
}

// Files of several scripts that were put together may mix units. Those of one program do not.
void Concluder::unify_units(const Reading& wanted, bool is_said) {
    const auto odd = find_odd_unit(cameras_,
                                   poses_,
                                   wanted,
                                   is_said ? std::optional(wanted) : std::nullopt,
                                   foreign_.has_matrix_poses);
    if (!odd) return;
    std::vector<std::string> names;
    for (const std::size_t i : odd->cameras) {
        poses_[i].vector *= odd->factor;
        names.push_back("'" + foreign_.cameras[i].known_name() + "'");
    }
    check(
        fmt::format("lengths: those of {} {} are in another unit than the others', and were "
                    "multiplied by {}; if the person is broken, write all in one unit",
                    names.size() == 1 ? "camera" : "cameras",
                    enumerated(names),
                    length_text(odd->factor)));
}

void Concluder::place_cameras(const Reading& reading) {
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        auto& pose = cameras_[i].camera_from_site;
        pose = camera_from_site(poses_[i], reading);
        if (said_.left_handed) pose = mirrored(pose);
    }
}

// Two lenses cannot be in one place.
void Concluder::report_same_poses() {
    for (std::size_t i = 1; i < poses_.size(); ++i) {
        const auto is_same = [&](const ForeignPose& pose) {
            return pose.rotation == poses_[i].rotation && pose.vector == poses_[i].vector;
        };
        const auto end = poses_.begin() + static_cast<std::ptrdiff_t>(i);
        const auto same = std::find_if(poses_.begin(), end, is_same);
        if (same == end) continue;
        problem(fmt::format(
            "poses: cameras '{0}' and '{1}' have exactly the same pose, so that of one "
            "was copied: calibrate it again, or leave it out with --cameras '!{1}'",
            foreign_.cameras[static_cast<std::size_t>(same - poses_.begin())].known_name(),
            foreign_.cameras[i].known_name()));
    }
}

// `camera` does not look at the place that most cameras, those of `looks`, look at.
void Concluder::report_elsewhere(std::size_t camera,
                                 const std::vector<bool>& looks,
                                 const Reading& common) {
    std::vector<geometry::CalibratedCamera> others;
    for (std::size_t i = 0; i < cameras_.size(); ++i)
        if (looks[i]) others.push_back(cameras_[i]);
    std::string cause =
        "its pose in the file is probably wrong, or older than the others: calibrate it again";
    if (is_at_origin(poses_[camera]) && foreign_.has_frame) {
        cause = "its pose is the origin, so it was probably never calibrated: calibrate it";
    } else if (const auto reading =
                   find_odd_reading(cameras_[camera], poses_[camera], others, common)) {
        cause = fmt::format(
            "it would if its pose were {}, unlike those of the others: write all poses in one way, "
            "or calibrate it again",
            describe(*reading));
    }
    problem(fmt::format(
        "poses: camera '{}' does not look at the place that the others look at: {}; remove it from "
        "the calibration if it is to look elsewhere",
        cameras_[camera].name,
        cause));
}

}  // namespace atrium::calibrate
