#include "tools/calibrate/conclude.hpp"

#include "tools/calibrate/concluder.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"
#include "tools/calibrate/judge/tape_check.hpp"
#include "tools/calibrate/names/name_parts.hpp"
#include "tools/calibrate/names/rig_name.hpp"
#include "tools/calibrate/picture_size.hpp"
#include "tools/calibrate/up_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

// Heights [m] above the floor of what cameras look at, if the file's floor is right.
constexpr double kLowestAim_m = 0.1;
constexpr double kHighestAim_m = 2.5;
constexpr double kUsualAim_m = 1.0;
constexpr double kFarOrigin_m = 10.0;
constexpr double kLooksUp = 0.05;  // mean sine

tl::unexpected<Error> needs(const std::string& text) {
    return make_error(ErrorKind::kConfiguration, text);
}

}  // namespace

Expected<std::size_t> Concluder::index_of(const std::string& name) const {
    const auto& cameras = foreign_.cameras;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (composed(cameras[i].known_name()) == composed(name)) return i;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (cameras[i].name == name) return i;
    std::vector<std::string> names;
    for (const auto& camera : cameras) names.push_back(camera.known_name());
    for (const Walked& camera : foreign_.walked)
        if (composed(camera.name) == composed(name)) return needs(camera.problem);
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
        if (auto doubt = doubt_measured(distance * *factor, from, to, metres); !doubt.empty()) {
            problem(std::move(doubt));
        } else if (auto small = doubt_small_measured(distance * *factor, from, to);
                   !small.empty()) {
            check(std::move(small));
        }
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

Expected<void> Concluder::find_heights() {
    measured_.distance = said_.distance;
    for (const auto& [name, metres] : said_.heights) {
        const auto camera = index_of(name);
        if (!camera) return tl::unexpected(camera.error());
        for (const MeasuredHeight& other : measured_.heights) {
            if (other.camera == *camera)
                return needs(
                    fmt::format("--camera-height gives {} two heights, {} and {} m: give "
                                "one of them, or name another camera",
                                name,
                                other.metres,
                                metres));
        }
        measured_.heights.push_back({*camera, metres});
    }
    return {};
}

void Concluder::find_up() {
    UpConclusion found = conclude_up(foreign_, cameras_, said_.up, measured_);
    for (std::string& text : found.told) tell(std::move(text));
    for (std::string& text : found.checks) check(std::move(text));
    for (std::string& text : found.problems) problem(std::move(text));
    floor_m_ = found.floor_m;
    if (!found.up) return;
    move({upright_from(*found.up).inverse(), Eigen::Vector3d::Zero()});
    is_turned_ = !found.is_axis;
    is_turned_axis_ = found.up->z() < 0.999;
}

void Concluder::find_floor() {
    const Convergence convergence = measure_convergence(cameras_);
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    const bool has_frame = foreign_.has_frame && !is_turned_ && !is_frame_of_camera_;
    // as of a surveyor's coordinates, or those of a whole hall
    const bool is_far = has_frame && convergence.point.cwiseAbs().maxCoeff() > kFarOrigin_m;
    const bool is_floor_of_file = has_frame && std::abs(convergence.point.z()) <= kFarOrigin_m;
    if (is_far) {
        check(
            fmt::format("origin: the cameras look at a place at ({:.4g}, {:.4g}, {:.4g}) m of the "
                        "file's frame, too far for a world, so it was moved below that place",
                        convergence.point.x(),
                        convergence.point.y(),
                        convergence.point.z()));
    } else if (!is_floor_of_file) {
        tell("origin: below the place that the cameras look at");
    }
    if (is_far || !is_floor_of_file) {
        origin = convergence.point;
        origin.z() = is_floor_of_file ? 0.0 : convergence.point.z() - kUsualAim_m;
    }
    if (measured_.heights.size() == 1) {
        const auto& [camera, metres] = measured_.heights.front();
        floor_m_ = cameras_[camera].centre_site().z() - metres;
    }
    has_floor_ = is_floor_of_file || floor_m_.has_value();
    origin.z() = floor_m_.value_or(origin.z());
    move({Eigen::Quaterniond::Identity(), origin});
    report_floor(convergence.point.z() - origin.z(), is_floor_of_file);
}

// What a tape proves, if lengths were measured: two wrong names in --distance show only there.
void Concluder::check_by_tape() {
    Measured measured;
    for (const MeasuredHeight& height : measured_.heights)
        measured.heights.push_back(height.camera);
    if (said_.distance)
        measured.distance = {*index_of(said_.distance->from), *index_of(said_.distance->to)};
    if (measured.heights.empty() && !measured.distance) return;
    if (auto text = tape_check(cameras_, measured, has_floor_); !text.empty())
        check(std::move(text));
}

// "floor: door hangs 1.54 m above it, as you say"
std::string Concluder::measured_text() const {
    std::vector<std::string> names;
    for (const Said::Height& height : said_.heights) names.push_back(height.camera);
    if (names.size() > 1) return "floor: from the heights of " + enumerated(names);
    return fmt::format(
        "floor: {} hangs {} m above it, as you say", names[0], said_.heights[0].metres);
}

// Left-handed poses make an image in a mirror, below the floor, of cameras that hang above it and
// look down at a place.
// So do right-handed ones that are said to be left-handed.
bool Concluder::looks_mirrored(double aim_m) const {
    if (!said_.up.empty() || -aim_m <= kLowestAim_m || -aim_m >= kHighestAim_m) return false;
    double looks_up = 0.0;  // sine, mean
    for (const auto& camera : cameras_) {
        if (camera.centre_site().z() >= 0.0) return false;
        const Eigen::Vector3d ahead =
            camera.camera_from_site.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        looks_up += ahead.z() / static_cast<double>(cameras_.size());
    }
    return looks_up > kLooksUp;
}

// The cameras look at a place `aim_m` above the new floor.
void Concluder::report_floor(double aim_m, bool is_of_file) {
    double lowest = 1e9;
    for (const auto& camera : cameras_) lowest = std::min(lowest, camera.centre_site().z());
    const std::string aim =
        fmt::format("{:.2f} m {} it", std::abs(aim_m), aim_m < 0.0 ? "below" : "above");
    const bool is_plausible = aim_m > kLowestAim_m && aim_m < kHighestAim_m && lowest > -0.1;
    if (!said_.heights.empty()) {
        const std::string text = measured_text() + ", so the cameras look at a place " + aim;
        if (is_plausible) {
            tell(text);
        } else {
            check(
                fmt::format("{}, and the lowest camera is at {:.2f} m; if that is wrong, measure "
                            "again: --camera-height {} METRES",
                            text,
                            lowest,
                            said_.heights.front().camera));
        }
    } else if (is_of_file && said_.left_handed && looks_mirrored(aim_m)) {
        problem(fmt::format(
            "floor: z = 0 of the {}; read as left-handed, all cameras hang below it and "
            "look up at a place {}: the poses look right-handed: leave --left-handed "
            "out",
            is_turned_axis_ ? "new frame" : "file",
            aim));
    } else if (is_of_file && looks_mirrored(aim_m)) {
        problem(
            fmt::format("floor: z = 0 of the {}; all cameras hang below it and look up at a place "
                        "{}: the poses look left-handed, as Unity writes them: say --left-handed. "
                        "If they are not, measure the height of one camera: --camera-height {} "
                        "METRES",
                        is_turned_axis_ ? "new frame" : "file",
                        aim,
                        cameras_[0].name));
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
    if (std::string doubt = doubt_of_shapes(foreign, sized); !doubt.empty())
        sized.problems.push_back(std::move(doubt));
    if (!unsized.empty()) {
        return needs(
            fmt::format("{} does not say the picture size of {}: give --recording with "
                        "the pictures, or --size 1920x1080",
                        foreign.format,
                        unsized));
    }
    read_point_offsets(sized);
    return Concluder(sized, said).run();
}

}  // namespace atrium::calibrate
