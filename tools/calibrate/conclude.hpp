#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/formats/foreign_rig.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// What the user knows better than the file and the cameras' geometry.
struct Said {
    std::string units;  // "m", "cm", "mm", "in", "ft"; empty: find out
    std::string up;     // "+Z", "-Y", ... or "x,y,z" in the file's axes; empty: find out
    std::optional<Reading::Pose> pose;
    std::optional<bool> opengl;
    bool left_handed = false;  // frames of the room and of the cameras (+Y up), as of Unity
    struct Distance {
        std::string from;
        std::string to;
        double metres = 0.0;
    };
    std::optional<Distance> distance;  // between two cameras; replaces units
    struct Height {
        std::string camera;
        double metres = 0.0;
    };
    std::vector<Height> heights;                        // of cameras above the floor
    std::optional<std::array<int, 2>> size;             // of the pictures: width, height
    std::optional<std::array<int, 2>> calibrated_size;  // of the pictures of the calibration
    double rate_hz = 30.0;
};

struct Conclusion {
    config::Rig rig;
    std::vector<std::string> told;      // sentences: what was found out, with figures
    std::vector<std::string> checks;    // assumptions, with the option that changes each
    std::vector<std::string> problems;  // no person, or a wrong one, will be seen; with the cure
};

/// Turns cameras of another program into a rig in metres, +Z up: finds out what their poses mean,
/// their unit and up, as far as `said` does not say. Errors are kConfiguration and name the option
/// that is needed.
Expected<Conclusion> conclude(const ForeignRig& foreign, const Said& said);

}  // namespace atrium::calibrate
