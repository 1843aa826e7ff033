#include "tools/calibrate/report/previous_rig.hpp"

#include "core/base/write_check.hpp"
#include "tools/calibrate/formats/rig_file.hpp"
#include "tools/calibrate/report/sweep_error.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

// Lengths of two good calibrations with one wand agree to a tenth of that.
constexpr double kOtherLength = 0.005;
// The rig before is still true if its errors are hardly larger than those of the new one, which
// was fitted to what both are measured with.
constexpr double kStillTrue = 1.15, kStillTrue_px = 0.03;

std::string move_text(const CameraMove& move, const fs::path& file) {
    return fmt::format("camera '{}' was moved by {:.0f} mm and turned by {:.2f} degrees since {}",
                       move.name,
                       1000.0 * move.moved_m,
                       move.turned_deg,
                       file.filename().string());
}

}  // namespace

Expected<std::optional<PreviousRig>> find_previous_rig(const fs::path& output,
                                                       const fs::path& frame_of,
                                                       bool force) {
    std::error_code failure;
    const bool exists = fs::exists(output, failure);
    std::optional<PreviousRig> previous;
    if (exists) {
        auto rig = is_rig_file(output)
                       ? config::load_rig(output)
                       : Expected<config::Rig>(make_error(
                             ErrorKind::kConfiguration,
                             fmt::format("{}: exists already and is no rig", output.string())));
        if (rig) {
            previous = PreviousRig{output, std::move(*rig), true};
        } else if (!force) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("{}; give another -o, or --force to replace it", rig.error().message));
        }
    }
    if (frame_of.empty()) return previous;
    auto rig = config::load_rig(frame_of);
    if (!rig) return tl::unexpected(rig.error());
    const bool is_output = exists && fs::equivalent(output, frame_of, failure);
    return PreviousRig{frame_of, std::move(*rig), is_output};
}

ComparisonVerdict judge_against(const PreviousRig& previous,
                                const RigComparison& comparison,
                                const Bundle& seen,
                                const config::Rig& new_rig) {
    ComparisonVerdict verdict;
    if (comparison.moves.empty()) {
        verdict.checks.push_back(
            fmt::format("{} has none of these cameras", previous.file.string()));
        return verdict;
    }
    const std::string file = previous.file.filename().string();
    const double ratio = comparison.length_ratio;
    if (std::abs(ratio - 1.0) > kOtherLength) {
        verdict.problems.push_back(fmt::format(
            "all distances between cameras are {:.1f} % {} than in {}: measure two cameras with a "
            "tape (--distance CAMERA CAMERA METRES); if they are right here, the rig before was "
            "wrong, else the lengths of the wand or board are",
            100.0 * std::abs(ratio - 1.0),
            ratio > 1.0 ? "longer" : "shorter",
            file));
        return verdict;
    }
    const auto before = sweep_error_px(seen, previous.rig), now = sweep_error_px(seen, new_rig);
    if (before && now) {
        verdict.told.push_back(
            fmt::format("{} explains what was seen to {:.2f} px, the new rig to {:.2f} px",
                        file,
                        *before,
                        *now));
        verdict.is_still_true = comparison.only_in_new.empty() && comparison.only_in_old.empty() &&
                                *before <= std::max(kStillTrue * *now, *now + kStillTrue_px);
    }
    for (const auto& [a, b] : comparison.exchanged)
        verdict.problems.push_back(
            fmt::format("cameras '{}' and '{}' stand in each other's place of {}: their names, "
                        "cables or serial numbers are exchanged; change them back, or --force if "
                        "you hung them so",
                        a,
                        b,
                        file));
    const std::size_t moved = comparison.moves.size() - comparison.num_staying();
    if (comparison.shares_frame()) {
        for (const CameraMove& move : comparison.moves)
            if (!move.stays) verdict.told.push_back(move_text(move, previous.file));
    } else if (moved > 0) {
        verdict.told.push_back(
            fmt::format("{} of {} cameras stand otherwise than in {}, so its frame cannot be kept",
                        moved,
                        comparison.moves.size(),
                        file));
    }
    return verdict;
}

Expected<fs::path> keep_old_rig(const fs::path& file) {
    const std::time_t now = std::time(nullptr);
    const std::string date = fmt::format("{:%Y-%m-%dT%H-%M-%S}", fmt::gmtime(now));
    for (int number = 1; number <= 100; ++number) {
        const fs::path kept =
            file.parent_path() / fmt::format("{}.{}{}{}",
                                             file.stem().string(),
                                             date,
                                             number == 1 ? "" : fmt::format("-{}", number),
                                             file.extension().string());
        std::error_code failure;
        if (fs::copy_file(file, kept, failure)) return kept;
        if (failure != std::errc::file_exists)
            return tl::unexpected(cannot_write(kept, "write", failure.value()));
    }
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("{}: no free name to keep it under", file.string()));
}

}  // namespace atrium::calibrate
