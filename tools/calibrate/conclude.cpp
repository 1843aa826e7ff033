#include "tools/calibrate/conclude.hpp"

#include "tools/calibrate/conclude_up.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"
#include "tools/calibrate/names/name_parts.hpp"
#include "tools/calibrate/names/rig_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

using CameraList = std::vector<geometry::CalibratedCamera>;

// Heights [m] above the floor of what cameras look at, if the file's floor is right.
constexpr double kLowestAim_m = 0.1;
constexpr double kHighestAim_m = 2.5;
constexpr double kUsualAim_m = 1.0;
tl::unexpected<Error> needs(const std::string& text) {
    return make_error(ErrorKind::kConfiguration, text);
}

// Without rotation and translation, but for rounding.
bool is_at_origin(const ForeignPose& pose) {
    return pose.rotation.isIdentity(1e-6) && pose.vector.isZero(1e-6);
}

// Concludes one thing after the other; each step leaves its sentences.
class Concluder {
public:
    Concluder(const ForeignRig& foreign, const Said& said) : foreign_(foreign), said_(said) {
        for (const ForeignCamera& camera : foreign.cameras) {
            cameras_.push_back({camera.name, camera.lens, {}});
            poses_.push_back(*camera.pose);
        }
    }

    Expected<Conclusion> run() {
        result_.told = foreign_.notes;
        result_.checks = foreign_.checks;
        result_.problems = foreign_.problems;
        read_poses();
        if (auto scaled = find_scale(); !scaled) return tl::unexpected(scaled.error());
        find_up();
        if (auto floor = find_floor(); !floor) return tl::unexpected(floor.error());
        result_.rig.cameras = cameras_;
        result_.rig.rate_hz = said_.rate_hz;
        return std::move(result_);
    }

private:
    void read_poses();
    void report_elsewhere(std::size_t camera);
    void report_same_poses();
    Expected<void> find_scale();
    Expected<double> said_scale() const;
    void find_up();
    void report_floor(double aim_m, bool is_of_file);
    Expected<void> find_floor();
    Expected<std::size_t> index_of(const std::string& name) const;

    void scale(double factor) {
        for (auto& camera : cameras_) camera.camera_from_site.translation *= factor;
    }
    void move(const geometry::RigidTransform& old_from_new) {
        for (auto& camera : cameras_)
            camera.camera_from_site = camera.camera_from_site * old_from_new;
    }
    void tell(std::string text) { result_.told.push_back(std::move(text)); }
    void check(std::string text) { result_.checks.push_back(std::move(text)); }
    void problem(std::string text) { result_.problems.push_back(std::move(text)); }

    const ForeignRig& foreign_;
    const Said& said_;
    CameraList cameras_;
    std::vector<ForeignPose> poses_;
    bool is_frame_of_camera_ = false;  // of one that stands at the origin of the file
    bool is_turned_ = false;           // into a frame that is not the file's
    bool is_turned_axis_ = false;      // z of the new frame is another axis of the file
    Conclusion result_;
};

void Concluder::read_poses() {
    Reading wanted = foreign_.documented;
    wanted.pose = said_.pose.value_or(wanted.pose);
    wanted.opengl = said_.opengl.value_or(wanted.opengl);
    ReadingChoice choice = choose_reading(cameras_, poses_, wanted, foreign_.has_matrix_poses);
    const ReadingChoice fitting = choice;
    report_same_poses();
    const bool is_said = said_.pose || said_.opengl;
    if (is_said || foreign_.is_sure_of_poses) choice = {wanted, {}, true, {}};
    for (std::size_t i = 0; i < cameras_.size(); ++i)
        cameras_[i].camera_from_site = camera_from_site(poses_[i], choice.reading);
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
        for (std::size_t i = 0; i < cameras_.size(); ++i)
            cameras_[i].camera_from_site = camera_from_site(poses_[i], wanted);
        const Convergence as_documented = measure_convergence(cameras_);
        for (std::size_t i = 0; i < cameras_.size(); ++i)
            cameras_[i].camera_from_site = camera_from_site(poses_[i], choice.reading);
        tell(
            fmt::format("poses: {}: {}, {:.0f} degrees apart. Read as documented, as {}, {} would "
                        "({} to read them so)",
                        describe(choice.reading),
                        looking,
                        2.0 * std::asin(std::sqrt(std::min(1.0, convergence.spread))) * 57.2958,
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
        if (!looks[i]) report_elsewhere(i);
        is_frame_of_camera_ = is_frame_of_camera_ || (looks[i] && is_at_origin(poses_[i]));
    }
    if (!is_said && !choice.also_possible.empty()) {
        check(
            fmt::format("poses: {} would fit the cameras as well; if the person is broken, try {}",
                        describe(choice.also_possible.front()),
                        option_of(choice.also_possible.front())));
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

// `camera` does not look at the place that most cameras look at.
void Concluder::report_elsewhere(std::size_t camera) {
    const bool is_default = is_at_origin(poses_[camera]) && foreign_.has_frame;
    problem(fmt::format(
        "poses: camera '{}' does not look at the place that the others look at: {}; remove it from "
        "the calibration if it is to look elsewhere",
        cameras_[camera].name,
        is_default ? "its pose is the origin, so it was probably never calibrated: calibrate it"
                   : "its pose in the file is probably wrong, or older than the others: calibrate "
                     "it again"));
}

Expected<std::size_t> Concluder::index_of(const std::string& name) const {
    const auto& cameras = foreign_.cameras;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (composed(cameras[i].known_name()) == composed(name)) return i;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (cameras[i].name == name) return i;
    std::vector<std::string> names;
    for (const auto& camera : cameras) names.push_back(camera.known_name());
    return needs(fmt::format("no camera '{}' in the calibration; it has {}",
                             name,
                             fmt::join(in_natural_order(names), ", ")));
}

// Metres per unit from --distance.
Expected<double> Concluder::said_scale() const {
    const auto from = index_of(said_.distance->from);
    if (!from) return tl::unexpected(from.error());
    const auto to = index_of(said_.distance->to);
    if (!to) return tl::unexpected(to.error());
    const double apart = (cameras_[*from].centre_site() - cameras_[*to].centre_site()).norm();
    if (!(apart > 1e-9)) return needs("--distance: the two cameras stand in one place");
    return said_.distance->metres / apart;
}

Expected<void> Concluder::find_scale() {
    const double distance = measure_convergence(cameras_).median_distance;
    if (said_.distance) {
        const auto factor = said_scale();
        if (!factor) return tl::unexpected(factor.error());
        scale(*factor);
        tell(
            fmt::format("lengths: {} to {} is {} m, so the cameras stand {:.2f} m from the place "
                        "that they look at",
                        said_.distance->from,
                        said_.distance->to,
                        said_.distance->metres,
                        distance * *factor));
        const auto& [from, to, metres] = *said_.distance;
        if (auto doubt = doubt_measured(distance * *factor, from, to, metres); !doubt.empty())
            problem(std::move(doubt));
        return {};
    }
    if (!foreign_.has_scale && said_.units.empty()) {
        return needs(
            fmt::format("{} has no scale: measure the distance between two cameras and give it in "
                        "metres: --distance {} {} METRES",
                        foreign_.format,
                        cameras_[0].name,
                        cameras_[1].name));
    }
    UnitChoice unit{metres_of(said_.units), said_.units, ""};
    if (said_.units.empty()) unit = choose_unit(distance, foreign_.units);
    if (unit.metres <= 0.0) {
        return needs(fmt::format(
            "lengths: the cameras are {} units from the place that they look at, which is no "
            "room in m, cm or mm; is one unit a square of the board? Measure the distance between "
            "two cameras: --distance {} {} METRES",
            length_text(distance),
            cameras_[0].name,
            cameras_[1].name));
    }
    scale(unit.metres);
    tell(
        fmt::format("lengths: {}{}: the cameras stand {} m from the place that they look at "
                    "(median)",
                    unit.name,
                    !said_.units.empty()          ? ", as you say"
                    : unit.name == foreign_.units ? ", as documented"
                    : foreign_.units.empty()      ? ", because that is a room"
                                                  : ", not " + foreign_.units + " as documented",
                    length_text(distance * unit.metres)));
    if (const std::string better = better_unit(distance, unit.name); !better.empty()) {
        problem(
            fmt::format("lengths: {} m from the cameras to the place that they look at is unusual; "
                        "as {} it would be {:.2f} m: say --units {}, if the room is not that {}",
                        length_text(distance * unit.metres),
                        better,
                        distance * metres_of(better),
                        better,
                        distance * unit.metres > 1.0 ? "large" : "small"));
    } else if (!unit.also_possible.empty() && said_.units.empty()) {
        check(
            fmt::format("lengths: {} is the likelier unit; in {} it would be {:.2f} m: --units {}",
                        unit.name,
                        unit.also_possible,
                        distance * metres_of(unit.also_possible),
                        unit.also_possible));
    }
    if (said_.units.empty() && unit.name != foreign_.units) {
        auto doubt = doubt_small_room(distance * unit.metres, cameras_[0].name, cameras_[1].name);
        if (!doubt.empty()) check(std::move(doubt));
    }
    return {};
}

void Concluder::find_up() {
    UpConclusion found = conclude_up(foreign_, cameras_, said_.up);
    for (std::string& text : found.told) tell(std::move(text));
    for (std::string& text : found.checks) check(std::move(text));
    for (std::string& text : found.problems) problem(std::move(text));
    if (!found.up) return;
    move({upright_from(*found.up).inverse(), Eigen::Vector3d::Zero()});
    is_turned_ = !found.is_axis;
    is_turned_axis_ = found.up->z() < 0.999;
}

Expected<void> Concluder::find_floor() {
    const Convergence convergence = measure_convergence(cameras_);
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    const bool is_floor_of_file = foreign_.has_frame && !is_turned_ && !is_frame_of_camera_;
    if (!is_floor_of_file) {
        origin = convergence.point;
        origin.z() -= kUsualAim_m;
        tell("origin: below the place that the cameras look at");
    }
    if (said_.height) {
        const auto camera = index_of(said_.height->camera);
        if (!camera) return tl::unexpected(camera.error());
        origin.z() = cameras_[*camera].centre_site().z() - said_.height->metres;
    }
    move({Eigen::Quaterniond::Identity(), origin});
    report_floor(convergence.point.z() - origin.z(), is_floor_of_file);
    return {};
}

// The cameras look at a place `aim_m` above the new floor.
void Concluder::report_floor(double aim_m, bool is_of_file) {
    double lowest = 1e9;
    for (const auto& camera : cameras_) lowest = std::min(lowest, camera.centre_site().z());
    const std::string aim =
        fmt::format("{:.2f} m {} it", std::abs(aim_m), aim_m < 0.0 ? "below" : "above");
    const bool is_plausible = aim_m > kLowestAim_m && aim_m < kHighestAim_m && lowest > -0.1;
    if (said_.height) {
        const std::string text = fmt::format(
            "floor: {} hangs {} m above it, as you say, so the cameras "
            "look at a place {}",
            said_.height->camera,
            said_.height->metres,
            aim);
        if (is_plausible) {
            tell(text);
        } else {
            check(
                fmt::format("{}, and the lowest camera is at {:.2f} m; if that is wrong, measure "
                            "again: --camera-height {} METRES",
                            text,
                            lowest,
                            said_.height->camera));
        }
    } else if (!is_of_file) {
        check(
            fmt::format("floor: unknown; {} m below what the cameras look at is assumed; measure "
                        "the height of one camera: --camera-height {} METRES",
                        kUsualAim_m,
                        cameras_[0].name));
    } else {
        const std::string text =
            fmt::format("floor: z = 0 of the {}; the cameras look at a place {}",
                        is_turned_axis_ ? "new frame" : "file",
                        aim);
        if (is_plausible) {
            tell(text);
        } else {
            check(
                fmt::format("{}, and the lowest camera is at {:.2f} m; if that is not the floor, "
                            "measure the height of one camera: --camera-height {} METRES",
                            text,
                            lowest,
                            cameras_[0].name));
        }
    }
}

}  // namespace

Expected<Conclusion> conclude(const ForeignRig& foreign, const Said& said) {
    ForeignRig sized = foreign;
    std::string unsized;
    for (ForeignCamera& camera : sized.cameras) {
        if (said.size) {
            if (auto set = set_picture_size(camera, *said.size); !set)
                return tl::unexpected(set.error());
        }
        if (camera.lens.width == 0 || camera.lens.height == 0)
            unsized += (unsized.empty() ? "" : ", ") + camera.name;
    }
    if (!unsized.empty()) {
        return needs(
            fmt::format("{} does not say the picture size of {}: give --recording with "
                        "the pictures, or --size 1920x1080",
                        foreign.format,
                        unsized));
    }
    return Concluder(sized, said).run();
}

}  // namespace atrium::calibrate
