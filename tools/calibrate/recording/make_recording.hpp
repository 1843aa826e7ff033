#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/recording/gather.hpp"

#include <filesystem>

namespace atrium::calibrate {

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
