#include "tools/calibrate/calibrated_rig.hpp"

#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace atrium::calibrate {

ForeignRig as_foreign(const Bundle& bundle, const std::string& source, bool has_scale) {
    ForeignRig rig;
    rig.format = source;
    rig.is_sure_of_poses = true;
    rig.units = "m";
    rig.has_scale = has_scale;
    rig.has_frame = false;
    for (const BundleCamera& camera : bundle.cameras) {
        ForeignCamera foreign;
        foreign.name = camera.name;
        foreign.lens = camera.intrinsics();
        foreign.has_lens = true;
        foreign.pose = foreign_pose(camera.camera_from_world(), rig.documented);
        rig.cameras.push_back(std::move(foreign));
    }
    return rig;
}

ProgressLine::ProgressLine() : is_terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
    if (is_terminal_) fmt::print(stderr, "\r\033[K");
}

void ProgressLine::show(const std::string& text) {
    if (!is_terminal_) return;
    fmt::print(stderr, "\r\033[K{} ...", text);
    std::fflush(stderr);
}

Expected<void> print_and_write(const RigReport& report,
                               const config::Rig& rig,
                               const std::filesystem::path& output,
                               bool force) {
    std::vector<std::string> comments{report.origin};
    const auto say = [&](const std::vector<std::string>& lines, const char* mark) {
        for (const std::string& line : lines) {
            fmt::print("{}{}\n", mark, line);
            comments.push_back(mark + line);
        }
    };
    say(report.told, "");
    say(report.checks, "check: ");
    say(report.problems, "problem: ");
    if (!report.problems.empty() && !force)
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("{} not written: solve {} above first, or give --force",
                        output.string(),
                        report.problems.size() == 1
                            ? "the problem"
                            : fmt::format("the {} problems", report.problems.size())));
    if (auto written = write_text(output, rig_text(rig, comments), force); !written) return written;
    fmt::print("wrote {}\n", output.string());
    return {};
}

}  // namespace atrium::calibrate
