#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/adjust/bundle.hpp"
#include "tools/calibrate/formats/foreign_rig.hpp"

#include <filesystem>
#include <string>
#include <vector>

/// What the subcommands that calibrate cameras from pictures share.
namespace atrium::calibrate {

/// The cameras of a calibration as those of another program that are known to be in metres, but in
/// no frame of a room. `source`: "the wand", for messages. `has_scale`: false if nothing gave it.
ForeignRig as_foreign(const Bundle& bundle, const std::string& source, bool has_scale);

/// A line that is written over on a terminal, and not at all elsewhere.
class ProgressLine {
public:
    ProgressLine();
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    void show(const std::string& text);

private:
    bool is_terminal_;
};

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
