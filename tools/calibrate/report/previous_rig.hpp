#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/adjust/bundle.hpp"
#include "tools/calibrate/report/compare_rigs.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// A rig that a calibration is compared with.
struct PreviousRig {
    std::filesystem::path file;
    config::Rig rig;
    bool is_output = false;  // it is what the new one would replace
};

/// The rig in whose frame the new one shall stand: `frame_of` if given, else the one that `output`
/// names, if there is one. Errors kConfiguration: `output` is something else than a rig, or cannot
/// be read, and may not be replaced (`force`).
Expected<std::optional<PreviousRig>> find_previous_rig(const std::filesystem::path& output,
                                                       const std::filesystem::path& frame_of,
                                                       bool force);

/// What the comparison says, as sentences for people.
struct ComparisonVerdict {
    std::vector<std::string> told, checks, problems;
    /// The rig before explains what was seen as well as the new one: nothing moved.
    bool is_still_true = false;
};

/// `seen`: what the new rig was made from.
ComparisonVerdict judge_against(const PreviousRig& previous,
                                const RigComparison& comparison,
                                const Bundle& seen,
                                const config::Rig& new_rig);

/// Copies a rig that is about to be replaced to "NAME.DATE.toml" beside it (UTC), which it returns.
/// Never replaces a file. Error kUnavailable.
Expected<std::filesystem::path> keep_old_rig(const std::filesystem::path& file);

}  // namespace atrium::calibrate
