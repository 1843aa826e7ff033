#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::calibrate {

struct ImportOptions {
    Files files;
    std::string format = "auto";
    std::filesystem::path output;  // rig.toml, or the folder of a recording
    Said said;
    bool has_rate = false;
    std::filesystem::path recording;   // folder with pictures; empty: only the calibration
    std::filesystem::path background;  // folder with pictures of the empty room
    bool copy = false;
    bool force = false;
};

/// What was done, as lines for people. `unsure` ones name what could not be known, and the cure.
struct ImportReport {
    std::vector<std::string> told;
    std::vector<std::string> unsure;
    std::string next;  // the command to run
};

/// Reads calibrations of other programs and writes rig.toml, or a recording with it. rig.toml comes
/// last, so a recording with one is complete. Errors name the file, the camera and the cure.
Expected<ImportReport> import(const ImportOptions& options);

}  // namespace atrium::calibrate
