#include "tools/calibrate/calibrated_rig.hpp"

#include "tools/calibrate/formats/rig_file.hpp"
#include "tools/calibrate/report/previous_rig.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace atrium::calibrate {

namespace fs = std::filesystem;

void print(const RigReport& report) {
    for (const std::string& line : report.told) fmt::print("{}\n", line);
    for (const std::string& line : report.checks) fmt::print("check: {}\n", line);
    for (const std::string& line : report.problems) fmt::print("problem: {}\n", line);
    std::fflush(stdout);  // before an error that says "above"
}

std::string cure_of_problems(std::size_t num_problems) {
    return fmt::format(
        "solve {} above first, or give --force",
        num_problems == 1 ? "the problem" : fmt::format("the {} problems", num_problems));
}

Expected<void> check_output(const fs::path& output, bool force) {
    const auto previous = find_previous_rig(output, {}, force);
    if (!previous) return tl::unexpected(previous.error());
    return {};
}

Expected<std::string> write_rig(const RigReport& report,
                                const config::Rig& rig,
                                const fs::path& output,
                                bool force) {
    const bool replaces = is_rig_file(output);
    if (!report.problems.empty() && !force)
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{} {}: {}",
                                      output.string(),
                                      replaces ? "stays as it was" : "not written",
                                      cure_of_problems(report.problems.size())));
    std::string kept;
    if (replaces) {
        const auto old = keep_old_rig(output);
        if (!old) return tl::unexpected(old.error());
        kept = fmt::format(", kept the one before as {}", old->string());
    }
    std::vector<std::string> comments{report.origin};
    comments.insert(comments.end(), report.told.begin(), report.told.end());
    for (const std::string& line : report.checks) comments.push_back("check: " + line);
    for (const std::string& line : report.problems) comments.push_back("problem: " + line);
    if (auto written = write_text(output, rig_text(rig, comments), true); !written)
        return tl::unexpected(written.error());
    return fmt::format("wrote {}{}", output.string(), kept);
}

Expected<void> print_and_write(const RigReport& report,
                               const config::Rig& rig,
                               const fs::path& output,
                               bool force) {
    print(report);
    const auto written = write_rig(report, rig, output, force);
    if (!written) return tl::unexpected(written.error());
    fmt::print("{}\n", *written);
    return {};
}

}  // namespace atrium::calibrate
