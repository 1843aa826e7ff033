#include "tools/calibrate/conclude_up.hpp"

#include "tools/calibrate/conclude_heights.hpp"
#include "tools/calibrate/judge/angles.hpp"
#include "tools/calibrate/judge/choose_up.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"
#include "tools/calibrate/up_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kOff_deg = 5.0;      // more than the horizon of level pictures is wrong
constexpr double kLying_deg = 45.0;   // people lie rather than lean
constexpr double kSameUp_deg = 15.5;  // near enough to name the cameras that are turned
constexpr double kIsAxis_deg = 0.01;

double tilt_deg(const UpChoice& found) {
    return std::asin(std::min(found.tilt, 1.0)) * kDegreesPerRad;
}

// What the user says, against the direction along which the pictures are upright.
void compare(UpConclusion& result, const UpChoice& found, const std::string& said) {
    const Eigen::Vector3d level = found.axis.empty() ? found.up : axis_vector(found.axis);
    const double off_deg = degrees_between(*result.up, level);
    if (!found.is_known || off_deg <= std::max(kOff_deg, tilt_deg(found))) return;
    // as good as what was found
    if (found.rival && degrees_between(*result.up, found.rival->up) <= kOff_deg) return;
    const std::string better = fmt::format("say --up {}, or leave --up out",
                                           found.axis.empty() ? direction_text(level) : found.axis);
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
                          int turn_deg,
                          const char* cure) {
        if (which.empty()) return;
        const bool is_one = which.size() == 1;
        result.told.push_back(fmt::format("up: {} {} {}: {} pictures are turned by {} degrees",
                                          is_one ? "camera" : "cameras",
                                          names_text(cameras, which),
                                          is_one ? one : several,
                                          is_one ? "its" : "their",
                                          turn_deg) +
                              cure);
    };
    name(found.on_side, "stands on its side", "stand on their side", 90, "");
    name(found.upside_down,
         "hangs upside down",
         "hang upside down",
         180,
         "; if they show the room upright, turn them back (videos: ffmpeg -i FILE -vf hflip,vflip "
         "OUT)");
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

// The cameras that roll against `found.up`: "; corner_a rolls by 7 degrees"
std::string rolled_text(const UpChoice& found, VotedCameras cameras) {
    std::vector<std::string> names;
    for (const auto& [camera, degrees] : found.rolled)
        names.push_back(fmt::format("{} by {:.0f}", cameras[camera].name, degrees));
    if (names.empty()) return {};
    return fmt::format("; {} {} degrees",
                       names.size() == 1 ? "one camera rolls," : "cameras roll,",
                       enumerated(names));
}

// Of the pictures' horizon: how good it is, and how to know better.
std::string horizon_text(const UpChoice& found, VotedCameras cameras, std::size_t num_heights) {
    return fmt::format(
        "up: taken from the pictures' horizon, by their scatter good to about {:.0f} degree{}{}. "
        "If it is wrong, people lean and stand in the floor or above it: measure the heights of {} "
        "cameras that stand on no line, and give --camera-height for each; now it is --up {}{}",
        std::ceil(found.error_deg),
        found.error_deg > 1.0 ? "s" : "",
        rolled_text(found, cameras),
        num_heights == 0 ? "three" : "two more",
        direction_text(found.up),
        found.other_up && !found.rival
            ? "; if people lie on their side, say --up " + option_text(*found.other_up)
            : "");
}

// Without measured heights.
UpConclusion up_of_pictures(const ForeignRig& foreign,
                            VotedCameras cameras,
                            const UpChoice& found,
                            std::size_t num_heights) {
    UpConclusion result;
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
        result.checks.push_back(horizon_text(found, cameras, num_heights));
    } else {
        result.checks.push_back(found.rival ? doubt_text(found, "+Z of the file", cameras.size())
                                            : text_of_kept(found));
        return result;
    }
    if (found.rival) {
        result.checks.push_back(doubt_text(found, "The first", cameras.size()));
    } else if (foreign.up.empty() && found.other_up && result.is_axis) {
        result.checks.push_back(
            fmt::format("up: if the cameras lie on their side, up is about {0}: say --up {0}",
                        option_text(*found.other_up)));
    }
    return result;
}

UpConclusion up_as_said(const UpChoice& found, const std::string& said) {
    UpConclusion result;
    result.up = up_vector(said);
    result.is_axis = degrees_between(*result.up, nearest_axis(*result.up)) < kIsAxis_deg;
    result.told.push_back("up: " + said + ", as you say");
    compare(result, found, said);
    return result;
}

}  // namespace

UpConclusion conclude_up(const ForeignRig& foreign,
                         std::span<const geometry::CalibratedCamera> cameras,
                         const std::string& said,
                         const Measurements& measured) {
    const UpChoice found = choose_up(cameras);
    UpConclusion result = said.empty()
                              ? up_of_pictures(foreign, cameras, found, measured.heights.size())
                              : up_as_said(found, said);
    if (measured.heights.size() > 1)
        conclude_heights(result, {cameras, found, !said.empty(), foreign.has_frame}, measured);
    if (result.up && found.is_known && degrees_between(*result.up, found.up) <= kSameUp_deg)
        name_turned(result, found, cameras);
    return result;
}

}  // namespace atrium::calibrate
