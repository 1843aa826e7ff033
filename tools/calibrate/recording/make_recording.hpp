#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/recording/gather.hpp"

#include <filesystem>
#include <vector>

namespace atrium::calibrate {

struct MakeOptions {
    bool copy = false;   // files instead of symbolic links
    bool force = false;  // replace links of an earlier recording
};

/// Makes the folder of a recording (docs/conventions.md#recordings), without rig.toml: that one
/// makes it complete and comes last. Of an earlier recording, removes rig.toml and symbolic links,
/// never anything else. Masks that a site would read otherwise than `mask_reading` says become
/// plain ones. Returns what it made, folders before their files; after an error nothing of that is
/// left.
Expected<std::vector<std::filesystem::path>> make_recording(const Material& material,
                                                            const std::filesystem::path& output,
                                                            const MakeOptions& options);

/// Removes what `make_recording` returned, except folders that hold something else.
void remove_made(const std::vector<std::filesystem::path>& made);

}  // namespace atrium::calibrate
