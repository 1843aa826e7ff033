#include "tools/calibrate/conclude_up.hpp"

#include "tools/calibrate/judge/choose_up.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kDegrees = 57.29578;
constexpr double kOff_deg = 5.0;     // more than the horizon of level pictures is wrong
constexpr double kLying_deg = 45.0;  // people lie rather than lean
constexpr double kAlongAxis_deg = 2.0;
constexpr double kIsAxis_deg = 0.01;

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegrees;
}

// "0.00, 1.00, 0.00", without negative zeros.
std::string numbers_text(const Eigen::Vector3d& v, int digits, const char* between) {
    const double scale = std::pow(10.0, digits);
    std::string text;
    for (const double x : v)
        text += fmt::format(
            "{}{:.{}f}", text.empty() ? "" : between, std::round(scale * x) / scale + 0.0, digits);
    return text;
}

std::string vector_text(const Eigen::Vector3d& v) { return "(" + numbers_text(v, 2, ", ") + ")"; }

double tilt_deg(const UpChoice& found) { return std::asin(std::min(found.tilt, 1.0)) * kDegrees; }

// The nearest axis, and how far it is from `v`.
Eigen::Vector3d nearest_axis(const Eigen::Vector3d& v) {
    int axis = 0;
    v.cwiseAbs().maxCoeff(&axis);
    return (v[axis] > 0.0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(axis);
}

// As --up takes it: "-Y" for an axis, else three numbers.
std::string option_text(const Eigen::Vector3d& v) {
    if (degrees_between(v, nearest_axis(v)) > kAlongAxis_deg) return numbers_text(v, 3, ",");
    int axis = 0;
    v.cwiseAbs().maxCoeff(&axis);
    return {v[axis] > 0.0 ? '+' : '-', "XYZ"[axis]};
}

// What the user says, against the direction along which the pictures are upright.
void compare(UpConclusion& result, const UpChoice& found, const std::string& said) {
    const Eigen::Vector3d level = found.axis.empty() ? found.up : axis_vector(found.axis);
    const double off_deg = degrees_between(*result.up, level);
    if (!found.is_known || off_deg <= std::max(kOff_deg, tilt_deg(found))) return;
    // as good as what was found
    if (found.rival && degrees_between(*result.up, found.rival->up) <= kOff_deg) return;
    const std::string better =
        fmt::format("say --up {}, or leave --up out",
                    found.axis.empty() ? numbers_text(level, 3, ",") : found.axis);
    if (off_deg < kLying_deg) {
        result.checks.push_back(
            fmt::format("up: {}, as you say, is {:.0f} degrees off the direction along which the "
                        "pictures are upright; if people lean, {}",
                        said,
                        off_deg,
                        better));
        return;
    }
    result.problems.push_back(fmt::format(
        "up: the pictures are upright along another direction, {} of the new frame, so people {}: "
        "{}",
        vector_text(upright_from(*result.up) * level),
        off_deg > 180.0 - kLying_deg ? "stand on their heads" : "lie on their side",
        better));
}

using VotedCameras = std::span<const geometry::CalibratedCamera>;

std::string names_text(VotedCameras cameras, const std::vector<std::size_t>& which) {
    std::string text;
    for (const std::size_t i : which)
        text += fmt::format("{}'{}'", text.empty() ? "" : ", ", cameras[i].name);
    return text;
}

// The cameras that are turned along `found.up`, if that is taken.
void name_turned(UpConclusion& result, const UpChoice& found, VotedCameras cameras) {
    if (found.on_side.size() == cameras.size()) {
        result.told.push_back(
            "up: all cameras stand on their side: their pictures are turned by "
            "90 degrees");
        return;
    }
    const auto name = [&](const std::vector<std::size_t>& which,
                          const char* one,
                          const char* several,
                          int turn_deg) {
        if (which.empty()) return;
        const bool is_one = which.size() == 1;
        result.told.push_back(fmt::format("up: {} {} {}: {} pictures are turned by {} degrees",
                                          is_one ? "camera" : "cameras",
                                          names_text(cameras, which),
                                          is_one ? one : several,
                                          is_one ? "its" : "their",
                                          turn_deg));
    };
    name(found.on_side, "stands on its side", "stand on their side", 90);
    name(found.upside_down, "hangs upside down", "hang upside down", 180);
}

// "--up +Z, along which 5 of 8 cameras are level and 3 stand on their side"
std::string vote_text(const UpVote& vote, std::size_t num_cameras) {
    std::string text = fmt::format("--up {}, along which {} of {} cameras are level",
                                   option_text(vote.up),
                                   vote.num_level,
                                   num_cameras);
    if (!vote.on_side.empty()) text += fmt::format(", {} on their side", vote.on_side.size());
    if (!vote.upside_down.empty()) text += fmt::format(", {} upside down", vote.upside_down.size());
    return text;
}

std::string doubt_text(const UpChoice& found, const std::string& taken, std::size_t num_cameras) {
    return fmt::format(
        "up: two directions are about as likely: {}; and {}. {} is taken; if people "
        "lie or stand on their heads, say the other one",
        vote_text(found, num_cameras),
        vote_text(*found.rival, num_cameras),
        taken);
}

// The frame of the file stays, for +Z is up in every format that prescribes it.
std::string text_of_kept(const UpChoice& found) {
    return fmt::format(
        "up: {}; +Z of the file is taken; if people lie or stand on their heads, say --up {}",
        found.is_known ? "the pictures are level along " + vector_text(found.up)
                       : "the cameras are tilted too differently to tell",
        found.is_known ? option_text(found.up) : "+Y, -Y, ...");
}

}  // namespace

UpConclusion conclude_up(const ForeignRig& foreign,
                         std::span<const geometry::CalibratedCamera> cameras,
                         const std::string& said) {
    const UpChoice found = choose_up(cameras);
    UpConclusion result;
    if (!said.empty()) {
        result.up = up_vector(said);
        result.is_axis = degrees_between(*result.up, nearest_axis(*result.up)) < kIsAxis_deg;
        result.told.push_back("up: " + said + ", as you say");
        compare(result, found, said);
        if (found.is_known && degrees_between(*result.up, found.up) <= kOff_deg)
            name_turned(result, found, cameras);
        return result;
    }
    if (found.is_known && !found.axis.empty() && foreign.has_frame) {
        result.up = up_vector(found.axis);
        result.told.push_back(
            fmt::format("up: {}{}: the pictures are level along it to {:.1f} degrees",
                        found.axis,
                        found.axis == foreign.up ? ", as documented" : "",
                        tilt_deg(found)));
    } else if (found.is_known && foreign.up.empty()) {
        result.up = found.up;
        result.is_axis = false;
        result.told.push_back(fmt::format(
            "up: the direction {} of the file, along which the pictures are level to {:.1f} "
            "degrees",
            vector_text(found.up),
            tilt_deg(found)));
        result.checks.push_back(fmt::format(
            "up: taken from the pictures' horizon, good to a degree or two: fine if "
            "people stand upright. If they lean, say which direction of the file is "
            "up: --up X,Y,Z; now it is --up {}{}",
            numbers_text(found.up, 3, ","),
            found.other_up && !found.rival
                ? "; if they lie on their side, say --up " + option_text(*found.other_up)
                : ""));
    } else {
        result.checks.push_back(found.rival ? doubt_text(found, "+Z of the file", cameras.size())
                                            : text_of_kept(found));
        return result;
    }
    name_turned(result, found, cameras);
    if (found.rival) {
        result.checks.push_back(doubt_text(found, "The first", cameras.size()));
    } else if (foreign.up.empty() && found.other_up && result.is_axis) {
        result.checks.push_back(
            fmt::format("up: if the cameras lie on their side, up is about {0}: say --up {0}",
                        option_text(*found.other_up)));
    }
    return result;
}

}  // namespace atrium::calibrate
