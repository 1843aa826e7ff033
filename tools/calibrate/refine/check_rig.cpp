#include "tools/calibrate/refine/check_rig.hpp"

#include "core/base/median.hpp"
#include "site_node/coherence/coherence.hpp"
#include "site_node/coherence/fault_text.hpp"
#include "site_node/rig_check/bounds_check.hpp"
#include "site_node/rig_check/diagnosis.hpp"
#include "site_node/rig_check/rig_geometry.hpp"
#include "tools/calibrate/refine/refine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace atrium::calibrate {
namespace {

using coherence::Verdict;

// A rig is no longer true as a whole if a refinement would halve its errors.
constexpr double kMuchBetter = 0.5;
constexpr double kGoodCoherence_px = 1.0;
constexpr double kExplained = 0.95;  // of the silhouettes, with a true rig
constexpr double kOneFactor = 0.02;  // lenses that differ by less from their median have it

// What other poses, or other lenses as well, make of the errors of held-out instants.
std::optional<Refined> refined_with(const config::Rig& rig, const Take& take, bool has_free_focal) {
    RefineOptions options;
    options.has_free_focal = has_free_focal;
    auto refined = refine(rig.cameras, take.sights, options);
    if (!refined || refined->held_out.empty()) return std::nullopt;
    return std::move(*refined);
}

// "all lenses are 1.10 times as long as the rig says", if one factor holds for all.
std::string factor_text(const config::Rig& rig, const Refined& refined) {
    std::vector<double> factors;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c)
        factors.push_back(refined.cameras[c].intrinsics.fx / rig.cameras[c].intrinsics.fx);
    const double middle = median_of(factors);
    const auto is_other = [&](double factor) {
        return std::abs(factor / middle - 1.0) > kOneFactor;
    };
    if (std::abs(middle - 1.0) < coherence::kOtherFactor || std::ranges::any_of(factors, is_other))
        return "other focal lengths than the rig says";
    return coherence::lenses_text(middle);
}

// Whether other cameras explain the silhouettes of held-out instants much better, with the command
// that finds them. `lenses`: one factor that explains them alone. `mend(options)` makes the
// command.
template <typename Mend>
std::string doubt_of_whole(const config::Rig& rig,
                           const Take& take,
                           const coherence::Report& report,
                           const std::optional<coherence::OtherLenses>& lenses,
                           const Mend& mend) {
    if (report.rms_px < coherence::kDoubtful_px) return {};
    const auto moved = refined_with(rig, take, false);
    const auto other = refined_with(rig, take, true);
    const double moved_px = moved ? moved->after.held_out : report.rms_px;
    // poses make up for a part of what lenses do
    if (other && other->after.held_out <= kMuchBetter * std::min(moved_px, other->before.held_out))
        return fmt::format(
            "{}, or mend the rig with {}",
            coherence::other_lenses_text(
                other->before.held_out, other->after.held_out, factor_text(rig, *other)),
            mend("--focal "));
    if (lenses)
        return fmt::format(
            "{}, or mend the rig with {}",
            coherence::other_lenses_text(
                lenses->before_px, lenses->after_px, coherence::lenses_text(lenses->factor)),
            mend("--focal "));
    if (moved && moved_px <= kMuchBetter * moved->before.held_out)
        return fmt::format(
            "the rig is no longer true: silhouettes differ by {:.2f} px, by {:.2f} px with other "
            "poses of its cameras: several cameras were moved, or the calibration was coarse: mend "
            "the rig with {}",
            moved->before.held_out,
            moved_px,
            mend(""));
    return {};
}

// A camera whose silhouettes hardly touch what the others see is judged by the few tangents that
// fit. `coverage`: the share of the silhouettes that the hull explains.
void check_silent_cameras(const config::Rig& rig,
                          const coherence::Report& report,
                          const std::string& recording,
                          double coverage,
                          RigCheck& check) {
    constexpr double kFew = 0.25;  // of the median
    if (coverage >= kExplained) return;
    std::vector<double> nums;
    for (const auto& camera : report.cameras)
        nums.push_back(static_cast<double>(camera.num_tangencies));
    if (nums.empty()) return;
    const double usual = median_of(nums);
    for (std::size_t c = 0; c < report.cameras.size(); ++c) {
        const auto num = static_cast<double>(report.cameras[c].num_tangencies);
        if (num >= kFew * usual || usual < coherence::Coherence::kLeastTangencies) continue;
        check.checks.push_back(fmt::format(
            "camera '{}' has {} tangents, others about {:.0f}: its silhouettes show more than the "
            "people whom the others see, as edges of the room if it was moved after the empty room "
            "was learned, or it sees too few of them: look at them with `site_node --recording {} "
            "--preview`",
            rig.cameras[c].name,
            report.cameras[c].num_tangencies,
            usual,
            recording));
    }
}

// Returns the cause of silhouettes that contradict each other; kUnknown without one.
rig_check::Cause check_coverage(const Take& take, double coverage, RigCheck& check) {
    using rig_check::Cause;
    check.told.push_back(
        fmt::format("coverage: the hull explains {:.1f} % of the silhouettes", 100.0 * coverage));
    if (coverage >= rig_check::kPoorShare || take.views.empty()) return Cause::kUnknown;
    const auto diagnosis = rig_check::diagnose(take.views[take.views.size() / 2], {});
    check.problems.push_back(diagnosis ? diagnosis->text
                                       : "the silhouettes contradict each other at some instants: "
                                         "look at them with `site_node --preview`");
    return diagnosis ? diagnosis->cause : Cause::kUnknown;
}

}  // namespace

void check_geometry(const config::Rig& rig, RigCheck& check) {
    for (const rig_check::Finding& finding : rig_check::check_rig(rig.cameras, rig.unit_m))
        (finding.is_error ? check.problems : check.checks).push_back(finding.text);
    if (!rig.has_bounds) return;
    if (auto doubt = rig_check::check_bounds(rig.bounds_site, rig.cameras, rig.unit_m))
        check.checks.push_back(std::move(doubt->text));
}

void check_silhouettes(const config::Rig& rig,
                       const Take& take,
                       const std::string& rig_name,
                       const std::string& recording_name,
                       RigCheck& check) {
    coherence::Coherence coherence(rig.cameras, take.sights.size());
    for (const coherence::Sight& sight : take.sights) coherence.add(sight);
    const coherence::Report report = coherence.judge();
    check.told.push_back(fmt::format("coherence: {:.2f} px, at {} instants with somebody who moves",
                                     report.rms_px,
                                     report.num_sights));
    for (std::size_t c = 0; c < report.cameras.size(); ++c) {
        const coherence::CameraCoherence& camera = report.cameras[c];
        if (camera.num_tangencies == 0) {
            check.told.push_back(
                fmt::format("camera '{}': no tangents: its silhouettes and those of the others are "
                            "never of one person",
                            rig.cameras[c].name));
            continue;
        }
        check.told.push_back(
            fmt::format("camera '{}': {:.2f} px; {:.0f} % of {} tangents within "
                        "{:.0f} px",
                        rig.cameras[c].name,
                        camera.rms_px,
                        100.0 * camera.share,
                        camera.num_tangencies,
                        coherence::kFits_px));
    }
    std::vector<std::size_t> all(take.sights.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const double coverage = coverage_of(take, all, rig.cameras);
    const rig_check::Cause cause = check_coverage(take, coverage, check);
    const bool blames_one = cause == rig_check::Cause::kOneCamera;
    const bool blames_two = cause == rig_check::Cause::kTwoCameras;
    // no refined pose mends swapped cameras or mirrored pictures; it would hide them
    if (cause != rig_check::Cause::kUnknown && !blames_one && !blames_two) return;
    if (!blames_one && !blames_two)
        check_silent_cameras(rig, report, recording_name, coverage, check);
    const auto mend = [&](const std::string& option) {
        return fmt::format("`calibrate refine {} {}--recording {} -o mended.toml`",
                           rig_name,
                           option,
                           recording_name);
    };
    const bool may_be_all =
        report.verdict == Verdict::kCoherent || report.verdict == Verdict::kIncoherent;
    if (may_be_all && blames_one) return;
    const auto lenses = may_be_all ? coherence.other_lenses() : std::nullopt;
    if (report.verdict == Verdict::kCoherent || lenses) {
        if (std::string doubt = doubt_of_whole(rig, take, report, lenses, mend); !doubt.empty()) {
            check.problems.push_back(std::move(doubt));
            return;
        }
    }
    switch (report.verdict) {
        case Verdict::kLenses:  // only of a site that watches
        case Verdict::kCoherent:
            if (report.rms_px > kGoodCoherence_px)
                check.checks.push_back(fmt::format(
                    "silhouettes differ by {:.2f} px, where a true rig gives less than {:.0f}, and "
                    "neither poses nor lenses explain it: are they good (`site_node --preview`), "
                    "and do all videos begin at the same instant?",
                    report.rms_px,
                    kGoodCoherence_px));
            return;
        case Verdict::kTooLittle:
            check.checks.push_back(
                fmt::format("{} instants with somebody who moves, seen by three cameras, are too "
                            "few to judge them; record a person who walks through the room, {} "
                            "instants or more",
                            report.num_sights,
                            coherence::Coherence::kLeastSights));
            return;
        case Verdict::kIncoherent:
            check.problems.push_back(fmt::format(
                "the silhouettes contradict the rig by {:.1f} px, and no single camera explains "
                "it: do all videos begin at the same instant? Else {} mends cameras that are off "
                "by up to 1 degree and 3 cm (with --focal also lenses); else calibrate again",
                report.rms_px,
                mend("")));
            return;
        case Verdict::kMoved: {
            const std::string& name = rig.cameras[report.fault->camera].name;
            check.problems.push_back(fmt::format(
                "camera '{}' {} since the calibration ({:.1f} px in its pictures; {:.2f} px remain "
                "without it): fix it, and mend the rig with {}",
                name,
                coherence::motion_text(*report.fault),
                report.fault->effect_px,
                report.fault->rms_after_px,
                mend(fmt::format("--camera {} ", name))));
            return;
        }
        case Verdict::kLate:
            check.problems.push_back(coherence::late_text(
                *report.fault, rig.cameras[report.fault->camera].name, take.rate_hz));
            return;
    }
}

}  // namespace atrium::calibrate
