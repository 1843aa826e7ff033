#include "tools/calibrate/calibrated_rig.hpp"

#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>

namespace atrium::calibrate {

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
