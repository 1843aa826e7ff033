#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/recording/shots.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// The pictures of a rig, found in a folder of another program.
struct Material {
    std::map<std::string, Shots> frames;       // by camera
    std::map<std::string, Shots> backgrounds;  // by camera; may lack some
    std::map<std::string, Look> looks;         // of the frames
    std::vector<std::string> missing;          // cameras without frames
    std::vector<std::string> told;
    std::vector<std::string> unsure;
    double rate_hz = 0.0;  // of the videos; 0: unknown
};

/// Finds frames and backgrounds of these cameras. `background` is a folder to search for the empty
/// room; empty: below `folder`, by name. Errors of `find_shots` and `match_shots`, and
/// kConfiguration if fewer than two cameras have frames.
Expected<Material> gather(const std::vector<std::string>& cameras,
                          const std::filesystem::path& folder,
                          const std::filesystem::path& background);

struct MakeOptions {
    bool copy = false;   // files instead of symbolic links
    bool force = false;  // replace links of an earlier recording
};
/// Makes the folder of a recording (docs/conventions.md#recordings), without rig.toml: that one
/// makes it complete and comes last. Never removes anything but symbolic links.
Expected<void> make_recording(const Material& material,
                              const std::filesystem::path& output,
                              const MakeOptions& options);

}  // namespace atrium::calibrate
