#include "tools/calibrate/refine/judge_refined.hpp"

#include "site_node/coherence/coherence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <numeric>

namespace atrium::calibrate {
namespace {

// Of the errors of held-out instants: a smaller gain is that of chance.
constexpr double kLeastBetter = 0.98;
constexpr double kLeastGain_px = 0.03;
constexpr double kCoverageNoise = 0.003;
constexpr double kWeak_deg = 0.5;
constexpr double kWeak_mm = 30.0;
constexpr std::size_t kFewSights = 10;
constexpr double kStays_deg = 0.002;
constexpr double kStays_mm = 0.05;
constexpr double kFar_deg = 5.0;
constexpr double kFar_mm = 200.0;
constexpr const char* kWalk =
    "record a person who walks through the whole space, near each camera and far from it, and "
    "raises the arms, for half a minute";

// Instants at which the person has moved since the one before.
std::size_t num_moving_sights(std::span<const geometry::CalibratedCamera> cameras,
                              const Take& take) {
    coherence::Coherence coherence({cameras.begin(), cameras.end()}, take.sights.size());
    for (const coherence::Sight& sight : take.sights) coherence.add(sight);
    return coherence.judge().num_sights;
}

}  // namespace

RefinedVerdict judge_refined(const Refined& refined,
                             std::span<const geometry::CalibratedCamera> old,
                             const Take& take,
                             bool is_whole) {
    RefinedVerdict verdict;
    std::vector<std::size_t> sights = refined.held_out;
    const bool has_held_out = !sights.empty();
    if (!has_held_out) {
        sights.resize(take.sights.size());
        std::iota(sights.begin(), sights.end(), std::size_t{0});
    }
    const double coverage_before = coverage_of(take, sights, old);
    const double coverage_after = coverage_of(take, sights, refined.cameras);
    const double before = has_held_out ? refined.before.held_out : refined.before.used;
    const double after = has_held_out ? refined.after.held_out : refined.after.used;
    const char* const of = has_held_out ? "instants that were not used" : "the instants it used";
    verdict.told.push_back(
        fmt::format("silhouettes: {} instants, {} tangents; {} instants held out",
                    take.sights.size(),
                    refined.num_tangencies,
                    refined.held_out.size()));
    verdict.told.push_back(
        fmt::format("coherence: {:.2f} px before, {:.2f} px after, of {}", before, after, of));
    verdict.told.push_back(
        fmt::format("coverage: {:.1f} % of the silhouettes before, {:.1f} % "
                    "after, of {}",
                    100.0 * coverage_before,
                    100.0 * coverage_after,
                    of));
    for (std::size_t c = 0; c < old.size(); ++c) {
        const double turned_deg = old[c].camera_from_site.rotation.angularDistance(
                                      refined.cameras[c].camera_from_site.rotation) *
                                  180.0 / std::numbers::pi;
        const double moved_mm =
            1000.0 * (old[c].centre_site() - refined.cameras[c].centre_site()).norm();
        if (turned_deg < kStays_deg && moved_mm < kStays_mm) continue;
        const double focal = refined.cameras[c].intrinsics.fx / old[c].intrinsics.fx;
        verdict.told.push_back(
            fmt::format("camera '{}': turned {:.2f} degrees, moved {:.1f} mm{}",
                        old[c].name,
                        turned_deg,
                        moved_mm,
                        focal == 1.0 ? "" : fmt::format(", f times {:.4f}", focal)));
        if (turned_deg > kFar_deg || moved_mm > kFar_mm)
            verdict.problems.push_back(fmt::format(
                "camera '{}' would turn by {:.1f} degrees and move by {:.0f} mm, too far for this "
                "refinement to be sure: calibrate it again; if that is impossible, because the "
                "recording is old, write it with --force and look at the person",
                old[c].name,
                turned_deg,
                moved_mm));
    }
    verdict.told.push_back(
        fmt::format("least certain: {:.2f} degrees and {:.0f} mm of a camera, together",
                    refined.weakest_deg,
                    refined.weakest_mm));
    const std::size_t num_moving = num_moving_sights(old, take);
    if (num_moving < kFewSights)
        verdict.problems.push_back(fmt::format(
            "{} instants with somebody who moves show too little: {}", num_moving, kWalk));
    if (refined.weakest_deg > kWeak_deg || refined.weakest_mm > kWeak_mm)
        verdict.problems.push_back(
            fmt::format("the silhouettes do not determine the cameras: one could turn by {:.2f} "
                        "degrees or move by {:.0f} mm and more unnoticed; {}{}",
                        refined.weakest_deg,
                        refined.weakest_mm,
                        kWalk,
                        is_whole ? "; or refine one camera alone, --camera NAME" : ""));
    if (after > std::min(kLeastBetter * before, before - kLeastGain_px))
        verdict.problems.push_back(
            fmt::format("the refined rig is no better ({:.2f} px, {:.2f} px before): the old one "
                        "is as good as these silhouettes can tell; keep it, or look at the "
                        "silhouettes with `site_node --preview`",
                        after,
                        before));
    else if (coverage_after < coverage_before - kCoverageNoise)
        verdict.problems.push_back(
            "the hull of the refined rig explains less of the silhouettes: some are wrong, for "
            "example where light changes; look at them with `site_node --preview`");
    return verdict;
}

}  // namespace atrium::calibrate
