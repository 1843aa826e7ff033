#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// The sentences of a calibration, printed and written into the rig's file.
struct RigReport {
    std::string origin;  // "Calibrated from X by `calibrate wand`."
    std::vector<std::string> told, checks, problems;
};

void print(const RigReport& report);

/// "solve the problem above first, or give --force".
std::string cure_of_problems(std::size_t num_problems);

/// Tells before the work whether its rig could be written. Error kConfiguration if `output` exists
/// and is no rig, or a damaged one, unless `force`.
Expected<void> check_output(const std::filesystem::path& output, bool force);

/// Writes the rig unless there are problems and `force` is not set. A rig that it replaces is kept
/// beside it. Returns what it did, as a sentence for people. Errors kInvalidData if there are
/// problems, kUnavailable if a file cannot be written.
Expected<std::string> write_rig(const RigReport& report,
                                const config::Rig& rig,
                                const std::filesystem::path& output,
                                bool force);

/// Prints the report, writes the rig, and prints what was done.
Expected<void> print_and_write(const RigReport& report,
                               const config::Rig& rig,
                               const std::filesystem::path& output,
                               bool force);

}  // namespace atrium::calibrate
