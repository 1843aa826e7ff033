#pragma once

#include "core/config/rig.hpp"
#include "tools/calibrate/refine/take.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// What a rig is worth, as sentences for people.
struct RigCheck {
    std::vector<std::string> told;      // figures
    std::vector<std::string> checks;    // what could not be judged, or looks odd
    std::vector<std::string> problems;  // what is wrong, with the cure
};

/// Judges the geometry of a rig alone (rig_check::check_rig).
void check_geometry(const config::Rig& rig, RigCheck& check);

/// Judges a rig by the silhouettes of a recording: how far they agree, whether one camera was moved
/// or is late, and how much of them the hull explains. `rig_name` and `recording_name` are those of
/// the command that mends it.
void check_silhouettes(const config::Rig& rig,
                       const Take& take,
                       const std::string& rig_name,
                       const std::string& recording_name,
                       RigCheck& check);

}  // namespace atrium::calibrate
