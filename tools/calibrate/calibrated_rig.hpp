#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// The sentences of a calibration, printed and written into the rig's file.
struct RigReport {
    std::string origin;  // "Calibrated from X by `calibrate wand`."
    std::vector<std::string> told, checks, problems;
};

/// Prints a report, and writes the rig unless there are problems and `force` is not set. Errors
/// kInvalidData if it is not written, those of `write_text`.
Expected<void> print_and_write(const RigReport& report,
                               const config::Rig& rig,
                               const std::filesystem::path& output,
                               bool force);

}  // namespace atrium::calibrate
