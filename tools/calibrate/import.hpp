#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Instead of the folder of masks: those below the recording are not used either.
inline constexpr const char* kNoMasks = "none";

struct ImportOptions {
    Files files;
    std::string format = "auto";
    std::filesystem::path output;      // rig.toml, or the folder of a recording
    std::vector<std::string> cameras;  // patterns of their names, as "00_*"; empty: all
    Said said;
    bool has_rate = false;
    std::filesystem::path recording;   // folder with pictures; empty: only the calibration
    std::string take;                  // pattern of names of pictures below it; empty: all
    std::filesystem::path background;  // folder with pictures of the empty room
    std::filesystem::path masks;       // folder with masks of the people, or kNoMasks
    std::string programs;              // before names of programs: "build/bin/"; or empty
    bool copy = false;
    bool invert_masks = false;  // people are black in them
    bool force = false;
};

/// What was done, as lines for people.
struct ImportReport {
    std::vector<std::string> told;
    std::vector<std::string> checks;    // assumptions, and the option that changes each
    std::vector<std::string> problems;  // a site will fail, or show no person or a wrong one; cures
    std::vector<std::string> next;      // commands, each for a terminal of its own
};

/// Reads calibrations of other programs and writes rig.toml, or a recording with it. rig.toml comes
/// last, so a recording with one is complete. Errors name the file, the camera and the cure.
Expected<ImportReport> import(const ImportOptions& options);

}  // namespace atrium::calibrate
