#include "site_node/rig_check/rig_watch.hpp"

#include "core/base/median.hpp"
#include "site_node/rig_check/diagnosis.hpp"
#include "site_node/rig_check/hull_size.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numbers>
#include <numeric>

namespace atrium::rig_check {
namespace {

constexpr std::size_t kRecent = 10;  // looks that judge coverage and bounds
constexpr std::size_t kRaysOfAll = 640;
constexpr std::size_t kFewestRays = 24;
// Looks that a finding needs: what pictures alone prove, and what a moving person may cause as
// well.
constexpr std::size_t kFewVotes = 3;
constexpr std::size_t kManyVotes = 10;
// A diagnosis takes much longer than a look: the first ones come with each poor look, then few.
constexpr std::size_t kQuickDiagnoses = 10;
constexpr std::chrono::seconds kDiagnosisPeriod{30};
constexpr const char* kAllDropped = "all_dropped";  // may be meant
constexpr const char* kSmall = "small";
constexpr const char* kTall = "tall";
constexpr const char* kLow = "low";  // may be right: told once
constexpr double kStanding = 0.9;    // of the heights are below that of people who stand
constexpr double kMargin = 0.05;     // of a height, above the head and below the feet
constexpr const char* kBelowFloor =
    "; if people reach far below z = 0, it is not the floor: import the calibration again with the "
    "measured height of a lens, --camera-height CAMERA METRES";
constexpr double kPersonFits_m = 1.5;  // bounds of less height are not for whole people
constexpr double kCutShare = 0.05;
constexpr double kCutHere_m = 0.05;     // a hull that ends so near the bounds may be cut
constexpr double kSeldomCut = 0.02;     // a look with less is not one that the bounds cut
constexpr std::size_t kBottomFace = 4;  // of Agreement::cut_by_face
constexpr std::size_t kTopFace = 5;
constexpr std::size_t kLeastHeights = 3;
constexpr std::size_t kMostHeights = 600;  // these have decided it

}  // namespace

RigWatch::Finding& RigWatch::vote(const std::string& key,
                                  std::size_t needed,
                                  const std::string& event,
                                  const std::string& reason) {
    Finding& finding = findings_[key];
    finding.needed = needed;
    finding.line = fmt::format("{} reason=\"{}\"", event, reason);
    // it ended, and is back
    if (num_looks_ > finding.voted_at + kStandingLooks) finding.standing_at.reset();
    finding.voted_at = num_looks_;
    ++finding.votes;
    num_good_looks_ = 0;
    finding.reason = reason;
    return finding;
}

std::vector<std::string> RigWatch::look(const Look& look,
                                        Clock::time_point now,
                                        const std::function<bool()>& go_on) {
    // the time of a look grows with the square of the number of cameras: many share the rays of
    // eight
    AgreementOptions options = options_;
    options.rays_per_camera =
        std::min(options.rays_per_camera,
                 std::max(kFewestRays, kRaysOfAll / std::max<std::size_t>(look.views.size(), 1)));
    const Agreement agreement = measure_agreement(look.views, options);
    ++num_good_looks_;  // a vote sets it back
    for (std::size_t i = 0; i < look.views.size(); ++i) {
        Camera& camera = cameras_[look.views[i].name];
        camera.rays += agreement.cameras[i].rays;
        camera.explained += agreement.cameras[i].explained;
        camera.silent += agreement.cameras[i].cut + agreement.cameras[i].beyond;
    }
    judge_shifted(look);
    judge_blind_cameras(look, agreement);
    if (agreement.num_rays() > 0) {
        ++num_looks_;
        judge_agreement(look, agreement, now, go_on);
        judge_bounds(look, agreement);
        judge_size(look, agreement);
        judge_floor(look);
        judge_height(look, agreement);
        judge_lowness(look, agreement);
    }
    judge_outside(look, agreement);
    std::vector<std::string> lines;
    for (auto& [key, finding] : findings_) {
        if (finding.votes < finding.needed) continue;
        if (finding.reported && (key == kLow || now - *finding.reported < kRepeat)) continue;
        finding.reported = now;
        if (!finding.standing_at) finding.standing_at = num_looks_;
        finding.votes = 0;  // it must hold again before it is repeated
        lines.push_back(finding.line);
        if (key != kAllDropped && key != kLow) last_reason_ = finding.reason;
    }
    return lines;
}

// Its silhouettes hold edges of the room, so that they do not show how the camera stands now.
void RigWatch::judge_shifted(const Look& look) {
    for (const Look::Shifted& shifted : look.shifted) {
        const double turn_deg = shifted.turn_rad * 180.0 / std::numbers::pi;
        vote(kShifted + shifted.camera,
             1,  // the pictures have proved it
             fmt::format("view_moved camera={} px={:.1f} degrees={:.2f}",
                         shifted.camera,
                         shifted.shift_px,
                         turn_deg),
             fmt::format("camera '{}' shows the room {:.0f} px beside the empty room that was "
                         "learned, as if it turned by {:.1f} degrees: it was moved. Fix it, learn "
                         "the empty room again (restart the site), and walk: the site then names "
                         "the command that mends the rig",
                         shifted.camera,
                         shifted.shift_px,
                         turn_deg));
    }
}

// A camera without any silhouette cuts everything away, and the site publishes empty meshes.
void RigWatch::judge_blind_cameras(const Look& look, const Agreement& agreement) {
    std::vector<std::string> seeing;
    for (const views::NamedView& view : look.views) {
        if (!view.view.contours.empty()) seeing.push_back(view.name);
    }
    if (seeing.size() < 2 || !options_.knows_outside) return;
    for (const views::NamedView& view : look.views) {
        Camera& camera = cameras_[view.name];
        if (!view.view.contours.empty()) {
            ++camera.looks_with_somebody;
            continue;
        }
        ++camera.looks_only_others;
        if (camera.looks_with_somebody > 0) continue;
        vote("blind " + view.name,
             kManyVotes,
             fmt::format("camera_sees_nobody camera={} looks={} others={} explained={:.2f}",
                         view.name,
                         camera.looks_only_others,
                         seeing.size(),
                         agreement.share()),
             fmt::format("{} has not seen anybody yet while {} cameras do, and what one camera "
                         "does not see is not in the hull: check its cover, its empty room (learn "
                         "it again) and where it looks, or leave it out",
                         view.name,
                         seeing.size()));
    }
}

// Bounds beside the people, for example in another frame, empty the hull as well.
void RigWatch::judge_outside(const Look& look, const Agreement& agreement) {
    const auto num_seeing = std::ranges::count_if(
        look.views, [](const auto& view) { return !view.view.contours.empty(); });
    if (!options_.bounds || num_looks_ > 0 || num_seeing < 2 || agreement.num_rays() > 0) return;
    const geometry::Aabb& box = *options_.bounds;
    vote("outside",
         kManyVotes,
         fmt::format("silhouettes_outside_bounds cameras={}", num_seeing),
         fmt::format("{} cameras see people, but none inside the bounds, {:.2f} to {:.2f} m: move "
                     "or enlarge hull.bounds, or [bounds] of the rig",
                     num_seeing,
                     fmt::join(box.min, ","),
                     fmt::join(box.max, ",")));
}

void RigWatch::judge_agreement(const Look& look,
                               const Agreement& agreement,
                               Clock::time_point now,
                               const std::function<bool()>& go_on) {
    recent_shares_.push_back(agreement.share());
    if (recent_shares_.size() > kRecent) recent_shares_.pop_front();
    if (agreement.share() >= (distort_much(look.views) ? kNearlyAllShare : kFineShare)) return;
    if (agreement.share() < kFineShare) num_good_looks_ = 0;
    // a camera that sees nobody explains all, and its empty room is the likeliest cause
    const auto is_blind = [](const auto& camera) {
        return camera.second.looks_with_somebody == 0 && camera.second.looks_only_others > 0;
    };
    if (std::ranges::any_of(cameras_, is_blind)) return;
    const bool is_soon = last_diagnosis_ && now - *last_diagnosis_ < kDiagnosisPeriod;
    if (is_soon && num_diagnoses_ >= kQuickDiagnoses) return;
    last_diagnosis_ = now;
    ++num_diagnoses_;
    const auto diagnosis = diagnose(look.views, options_, go_on);
    if (!diagnosis) return;
    const double mean = std::accumulate(recent_shares_.begin(), recent_shares_.end(), 0.0) /
                        static_cast<double>(recent_shares_.size());
    const std::size_t worst = agreement.worst();
    const bool is_certain = diagnosis->cause != Cause::kUnknown;
    if (!is_certain && mean >= kPoorShare) return;  // a single bad look
    // uncertain causes share a key: the worst camera may change from look to look
    const std::string key = is_certain ? fmt::format("{} {}",
                                                     static_cast<int>(diagnosis->cause),
                                                     fmt::join(diagnosis->cameras, " "))
                                       : fmt::format("{}", static_cast<int>(diagnosis->cause));
    Finding& finding = vote(
        key,
        kFewVotes,
        fmt::format("cameras_contradict explained={:.2f} worst={}:{:.2f}{}",
                    mean,
                    look.views[worst].name,
                    agreement.cameras[worst].share(),
                    is_certain ? fmt::format(" explained_then={:.2f}", diagnosis->share_if) : ""),
        diagnosis->text);
    // cameras that contradict all others may have been moved, too
    finding.explains = is_certain && diagnosis->cause != Cause::kOneCamera &&
                       diagnosis->cause != Cause::kTwoCameras;
}

bool RigWatch::stands(const Finding& finding) const {
    return finding.standing_at && num_looks_ <= finding.voted_at + kStandingLooks;
}

bool RigWatch::is_explained() const {
    return std::ranges::any_of(findings_, [&](const auto& entry) {
        // or will soon be certain
        return entry.second.explains &&
               (stands(entry.second) || num_looks_ < entry.second.voted_at + kRecent);
    });
}

void RigWatch::judge_bounds(const Look& look, const Agreement& agreement) {
    if (!options_.bounds) return;
    std::size_t cut = 0;
    std::size_t most = 0;
    for (std::size_t i = 0; i < agreement.cameras.size(); ++i) {
        cut += agreement.cameras[i].cut;
        if (agreement.cameras[i].cut > agreement.cameras[most].cut) most = i;
    }
    recent_cuts_.push_back({agreement.num_rays(), cut});
    if (recent_cuts_.size() > kRecent) recent_cuts_.pop_front();
    Cut sum;
    std::size_t looks = 0;
    for (const Cut& one : recent_cuts_) {
        sum.rays += one.rays;
        sum.cut += one.cut;
        looks += static_cast<double>(one.cut) > kSeldomCut * static_cast<double>(one.rays) ? 1 : 0;
    }
    const double share = static_cast<double>(sum.cut) / static_cast<double>(sum.rays);
    if (share < kCutShare || 2 * looks <= recent_cuts_.size()) return;
    const auto face = static_cast<std::size_t>(
        std::max_element(agreement.cut_by_face.begin(), agreement.cut_by_face.end()) -
        agreement.cut_by_face.begin());
    if (agreement.cut_by_face[face] == 0) return;
    const bool is_above = face % 2 == 1;
    const auto axis = static_cast<int>(face / 2);
    const double limit_m = is_above ? options_.bounds->max[axis] : options_.bounds->min[axis];
    const CameraAgreement& camera = agreement.cameras[most];
    vote("bounds",
         kFewVotes,
         fmt::format("bounds_cut_people share={:.2f} camera={} camera_share={:.2f}",
                     share,
                     look.views[most].name,
                     static_cast<double>(camera.cut) /
                         static_cast<double>(std::max<std::size_t>(camera.rays, 1))),
         fmt::format("the bounds cut people at {} = {:.2f} m, where the bounds end at {:.2f} m: "
                     "enlarge hull.bounds, or [bounds] of the rig{}",
                     "xyz"[axis],
                     agreement.farthest_cut_m[face],
                     limit_m,
                     axis == 2 && !is_above && limit_m < kCutHere_m ? kBelowFloor : ""));
}

void RigWatch::judge_size(const Look& look, const Agreement& agreement) {
    if (!look.is_hull_whole) return;
    if (const auto wrong = check_size(look.hull_extent, look.hull_volume_m3, agreement.share())) {
        vote("size", kFewVotes, "hull_size_implausible", *wrong);
    } else {
        judge_smallness(look, agreement);
    }
    const bool all_see = std::all_of(look.views.begin(), look.views.end(), [](const auto& view) {
        return !view.view.contours.empty();
    });
    std::size_t cut = 0;
    for (const CameraAgreement& camera : agreement.cameras) cut += camera.cut;
    if (!look.hull_extent.empty() || !all_see || look.views.size() < 3 || cut > 0 ||
        agreement.share() < kPoorShare)
        return;
    vote(kAllDropped,
         kFewVotes,
         fmt::format("hull_empty explained={:.2f}", agreement.share()),
         "the hull is empty although the silhouettes fit: nobody is inside the bounds, or all is "
         "smaller than hull.min_component_l because the translations of the rig are in another "
         "unit");
}

// Lengths in squares of a chessboard make people of half a metre, who fit together as well.
void RigWatch::judge_smallness(const Look& look, const Agreement& agreement) {
    if (look.hull_extent.empty() || has_seen_large_) return;
    if (!is_small_for_person(look.hull_extent, look.hull_volume_m3)) {
        has_seen_large_ = true;
        findings_.erase(kSmall);
        return;
    }
    if (options_.bounds && options_.bounds->size().z() < kPersonFits_m) return;
    std::size_t hidden = 0;
    for (const CameraAgreement& camera : agreement.cameras) hidden += camera.cut + camera.beyond;
    const bool is_whole =
        static_cast<double>(hidden) < kCutShare * static_cast<double>(agreement.num_rays());
    const bool all_see = std::ranges::all_of(
        look.views, [](const auto& view) { return !view.view.contours.empty(); });
    if (!is_whole || !all_see || agreement.share() < kPoorShare) return;
    vote(kSmall,
         kManyVotes,
         "hull_size_implausible",
         doubt_small_hull(look.hull_extent, look.hull_volume_m3));
}

// A calibration with a board on a table has its floor at the table's height.
void RigWatch::judge_floor(const Look& look) {
    if (!look.footing || is_explained()) return;
    const Eigen::Vector3d& feet = look.footing->feet_site;
    // bounds above the floor are not for whole people
    if (options_.bounds &&
        (options_.bounds->min.z() > kCutHere_m || feet.z() < options_.bounds->min.z() + kCutHere_m))
        return;
    floor_.add(*look.footing,
               sees_floor(look.views, feet, options_.knows_outside) ||
                   (options_.knows_outside && shows_lower_end(look.views, *look.footing)));
    const auto feet_m = floor_.feet_off_floor_m();
    if (!feet_m) return;
    const views::NamedView& first = look.views.front();
    vote("floor",
         1,
         fmt::format("feet_off_floor metres={:.2f}", *feet_m),
         explain_floor(*feet_m, first.name, first.view.camera_from_site.inverse().translation.z()));
}

// Squares of a chessboard that were said too large make giants, whose silhouettes fit as well.
void RigWatch::judge_height(const Look& look, const Agreement& agreement) {
    if (!look.footing || agreement.share() < kPoorShare || heights_m_.size() >= kMostHeights)
        return;
    heights_m_.push_back(look.footing->height_m);
    if (heights_m_.size() < kLeastHeights) return;
    if (const auto doubt = doubt_tall_people(median_of(heights_m_)))
        vote(kTall, kManyVotes, "hull_size_implausible", *doubt);
    else
        findings_.erase(kTall);
}

// A wand that was said too short makes children of adults, whose silhouettes fit as well.
void RigWatch::judge_lowness(const Look& look, const Agreement& agreement) {
    const auto told = findings_.find(kLow);
    if (!look.footing || !has_seen_large_ || agreement.share() < kPoorShare ||
        whole_heights_m_.size() >= kMostHeights ||
        (told != findings_.end() && told->second.reported))
        return;
    const Eigen::Vector3d& feet = look.footing->feet_site;
    const double height_m = look.footing->height_m;
    const auto is_seen = [&](double z_m) {
        return sees_place(
            look.views, feet + Eigen::Vector3d(0.0, 0.0, z_m), options_.knows_outside);
    };
    const auto cut =
        static_cast<double>(agreement.cut_by_face[kBottomFace] + agreement.cut_by_face[kTopFace]);
    if (cut > kCutShare * static_cast<double>(agreement.num_rays()) ||
        !is_seen(-kMargin * height_m) || !is_seen((1.0 + kMargin) * height_m))
        return;
    whole_heights_m_.push_back(height_m);
    if (whole_heights_m_.size() < kLeastHeights) return;
    const auto standing = whole_heights_m_.begin() +
                          static_cast<std::ptrdiff_t>(
                              kStanding * static_cast<double>(whole_heights_m_.size() - 1) + 0.5);
    std::ranges::nth_element(whole_heights_m_, standing);
    if (const auto doubt = doubt_small_people(*standing))
        vote(kLow, kManyVotes, fmt::format("people_are_small height_m={:.2f}", *standing), *doubt);
    else
        findings_.erase(kLow);
}

std::string RigWatch::standing_reason() const {
    const Finding* first = nullptr;
    for (const auto& [key, finding] : findings_) {
        if (!stands(finding) || key == kAllDropped || key == kLow) continue;
        const bool is_first = first == nullptr || *finding.standing_at < *first->standing_at;
        if (first == nullptr || first->explains == finding.explains ? is_first : finding.explains)
            first = &finding;
    }
    return first == nullptr ? std::string() : first->reason;
}

std::vector<std::string> RigWatch::finish() {
    std::vector<std::string> lines;
    for (const auto& [key, finding] : findings_) {
        // in a short run most looks must have said it
        if (finding.reported || 2 * finding.votes <= std::min<std::size_t>(num_looks_, kFewVotes))
            continue;
        lines.push_back(finding.line);
        if (key != kAllDropped && key != kLow) last_reason_ = finding.reason;
    }
    return lines;
}

}  // namespace atrium::rig_check
