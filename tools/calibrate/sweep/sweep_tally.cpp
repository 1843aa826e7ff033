#include "tools/calibrate/sweep/sweep_tally.hpp"

#include "tools/calibrate/sweep/sweep_progress.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr double kMovedShare = 1.0 / 160.0;  // of the picture's width: then an instant counts
constexpr double kKeptShare = 1.0 / 1280.0;  // then its points are kept
constexpr double kEnoughCovered = 0.35;      // of the fields; the verdict asks for less
constexpr std::size_t kLinked = 20;          // instants that link two cameras
constexpr std::size_t kMostPoints = 24;      // of a picture: what the labeller looks at
constexpr std::size_t kFewestInstants = 20;  // below, nothing can be solved
constexpr double kBright = 60.0;             // [grey levels] of a picture's background
constexpr double kNoLight_s = 5.0, kNoPicture_s = 5.0, kRepeat_s = 20.0;
constexpr std::size_t kInARow = 10;

enum Kind : std::size_t { kNoLight, kNoPicture, kTooBright, kCrowded };

// True if a wand is new in the picture, or one of its lights is `most_px` from where it was.
bool has_moved(const std::vector<Eigen::Vector2d>& now,
               const std::vector<Eigen::Vector2d>& before,
               double most_px) {
    if (now.empty()) return false;
    if (before.size() != now.size()) return true;
    for (std::size_t i = 0; i < now.size(); ++i)
        if ((now[i] - before[i]).norm() >= most_px) return true;
    return false;
}

}  // namespace

Expected<SweepTally> SweepTally::make(const Wand& wand,
                                      std::vector<NominalCamera> cameras,
                                      const TallyOptions& options) {
    auto labeller = LightLabeller::make(wand);
    if (!labeller)
        return make_error(ErrorKind::kConfiguration,
                          "the lights of this wand look alike: a sweep needs one light, three or "
                          "more on a line with distances that differ from both ends, or a flat "
                          "shape that looks different turned");
    return SweepTally(std::move(*labeller), std::move(cameras), options);
}

SweepTally::SweepTally(LightLabeller labeller,
                       std::vector<NominalCamera> cameras,
                       const TallyOptions& options)
    : labeller_(std::move(labeller)), options_(options), links_(cameras.size()) {
    for (NominalCamera& camera : cameras) {
        tallies_.emplace_back(camera);
        cameras_.emplace_back().nominal = std::move(camera);
    }
}

void SweepTally::add(std::uint32_t instant,
                     const std::vector<std::optional<DetectedLights>>& seen) {
    ++num_added_;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        look(c, seen[c]);
        notice(c, seen[c]);
    }
    bool is_kept = false;
    for (std::size_t c = 0; c < cameras_.size(); ++c)
        is_kept = is_kept || has_moved(tallies_[c].wand_px,
                                       cameras_[c].kept_px,
                                       kKeptShare * cameras_[c].nominal.width);
    if (!is_kept) return;  // a wand at rest tells nothing new
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        const CameraTally& tally = tallies_[c];
        cameras_[c].kept_px = tally.wand_px;
        for (const auto* several : {&tally.wand_px, &tally.others_px})
            for (const Eigen::Vector2d& px : *several)
                cameras_[c].points.push_back({instant, std::nullopt, px});
    }
    count();
}

// Finds the wand among the lights of a picture.
void SweepTally::look(std::size_t c, const std::optional<DetectedLights>& seen) {
    CameraTally& tally = tallies_[c];
    tally.wand_px.clear();
    tally.others_px.clear();
    if (!seen) return;
    ++tally.num_pictures;
    tally.background = seen->background;
    std::vector<Eigen::Vector2d> spots, moving;
    for (const DetectedLight& light : seen->lights) spots.push_back(light.px);
    const std::vector<bool> is_fixed = cameras_[c].fixed.add(spots);
    for (std::size_t i = 0; i < spots.size() && moving.size() < kMostPoints; ++i)
        if (!is_fixed[i]) moving.push_back(spots[i]);
    tally.num_with_lights += moving.empty() ? 0 : 1;
    const auto labels = labeller_.label(moving);
    if (labels) {
        for (const std::size_t i : *labels) tally.wand_px.push_back(moving[i]);
    }
    for (std::size_t i = 0; i < moving.size(); ++i)
        if (!labels || std::ranges::find(*labels, i) == labels->end())
            tally.others_px.push_back(moving[i]);
}

// Notices cameras that will show no wand however it is swept.
void SweepTally::notice(std::size_t c, const std::optional<DetectedLights>& seen) {
    Camera& camera = cameras_[c];
    const std::string& name = camera.nominal.name;
    const auto instants = [&](double seconds) {
        return static_cast<std::size_t>(seconds * options_.rate_hz);
    };
    if (!seen) {
        if (++camera.since_picture >= instants(kNoPicture_s))
            warn(c, kNoPicture, fmt::format("camera '{}' sends no pictures", name));
        return;
    }
    camera.since_picture = 0;
    const bool has_light = !tallies_[c].wand_px.empty() || !tallies_[c].others_px.empty();
    camera.since_light = has_light ? 0 : camera.since_light + 1;
    camera.num_bright = seen->background > kBright ? camera.num_bright + 1 : 0;
    camera.num_crowded = tallies_[c].wand_px.empty() && tallies_[c].others_px.size() >= kMostPoints
                             ? camera.num_crowded + 1
                             : 0;
    if (camera.num_bright >= kInARow)
        warn(c,
             kTooBright,
             fmt::format("camera '{}': the picture is bright all over ({:.0f} of 255): shorten the "
                         "exposure or darken the room",
                         name,
                         seen->background));
    else if (camera.num_crowded >= kInARow)
        warn(c,
             kCrowded,
             fmt::format("camera '{}' sees {} bright spots or more: cover lamps and what reflects "
                         "them, lower its gain, or give --light-threshold above {:.0f}",
                         name,
                         kMostPoints,
                         seen->threshold));
    else if (camera.since_light >= instants(kNoLight_s))
        warn(c,
             kNoLight,
             fmt::format("camera '{}' sees no light: is it covered, or its exposure too long or "
                         "too short? Its picture has a background of {:.0f} of 255 and a noise of "
                         "{:.1f}; spots from {:.0f} above it count as lights",
                         name,
                         seen->background,
                         seen->noise,
                         seen->threshold));
}

void SweepTally::warn(std::size_t c, std::size_t kind, std::string text) {
    std::size_t& warned_at = cameras_[c].warned_at[kind];
    const auto pause = static_cast<std::size_t>(kRepeat_s * options_.rate_hz);
    if (warned_at != 0 && num_added_ < warned_at + pause) return;
    warned_at = num_added_;
    warnings_.push_back(std::move(text));
}

std::vector<std::string> SweepTally::take_warnings() { return std::exchange(warnings_, {}); }

void SweepTally::count() {
    std::vector<std::size_t> seeing;
    bool is_new = false;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        if (tallies_[c].wand_px.empty()) continue;
        seeing.push_back(c);
        is_new = is_new || has_moved(tallies_[c].wand_px,
                                     cameras_[c].counted_px,
                                     kMovedShare * cameras_[c].nominal.width);
    }
    if (seeing.size() < 2 || !is_new) return;
    ++num_counted_;
    for (const std::size_t c : seeing) {
        ++tallies_[c].num_instants;
        for (const Eigen::Vector2d& px : tallies_[c].wand_px) tallies_[c].covered.cover(px);
    }
    links_.count(seeing);
    for (std::size_t c = 0; c < cameras_.size(); ++c) cameras_[c].counted_px = tallies_[c].wand_px;
}

bool SweepTally::has_enough(std::size_t c) const {
    return tallies_[c].num_instants >= num_needed_of_each() &&
           tallies_[c].covered.share() >= kEnoughCovered;
}

bool SweepTally::is_complete() const {
    if (num_counted_ < num_needed()) return false;
    for (std::size_t c = 0; c < cameras_.size(); ++c)
        if (!has_enough(c)) return false;
    return links_.unlinked(kLinked).empty();
}

std::string SweepTally::need_of(std::size_t c) const {
    if (has_enough(c)) return {};
    const CameraTally& tally = tallies_[c];
    const std::string counted =
        tally.num_instants < num_needed_of_each()
            ? fmt::format("{} of {}", tally.num_instants, num_needed_of_each())
            : fmt::format("{:.0f} % of its picture", 100.0 * tally.covered.share());
    return fmt::format("{}, sweep its {}", counted, tally.covered.emptiest_part());
}

std::string SweepTally::progress(std::size_t most_characters) const {
    std::string text =
        fmt::format("sweep: {} of {} instants", std::min(num_counted_, num_needed()), num_needed());
    std::vector<std::size_t> needy;
    std::vector<std::string> enough;
    for (std::size_t c = 0; c < cameras_.size(); ++c)
        has_enough(c) ? enough.push_back(cameras_[c].nominal.name) : needy.push_back(c);
    std::ranges::stable_sort(needy, {}, [this](std::size_t c) { return tallies_[c].num_instants; });
    std::vector<std::string> parts;
    for (const std::size_t c : needy)
        parts.push_back(fmt::format("{}: {}", cameras_[c].nominal.name, need_of(c)));
    if (needy.empty()) {
        std::vector<std::string> apart;
        for (const std::size_t c : links_.unlinked(kLinked))
            apart.push_back(cameras_[c].nominal.name);
        if (!apart.empty())
            parts.push_back(fmt::format("sweep where {} and the others see the wand at once",
                                        fmt::join(apart, ", ")));
    }
    if (!enough.empty()) parts.push_back(fmt::format("enough: {}", fmt::join(enough, ", ")));
    return progress_line(std::move(text), parts, most_characters);
}

LightPoints SweepTally::points() const {
    LightPoints points;
    for (const Camera& camera : cameras_) {
        LightCamera& out = points.emplace_back();
        out.name = camera.nominal.name;
        for (const LightPoint& point : camera.points)
            if (!camera.fixed.is_fixed(point.px)) out.points.push_back(point);
    }
    return points;
}

std::string SweepTally::why_too_little() const {
    if (num_counted_ >= kFewestInstants) return {};
    std::string text =
        fmt::format("only {} instants show the moving wand in two cameras at once, of {} in all:",
                    num_counted_,
                    num_added_);
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        const CameraTally& tally = tallies_[c];
        text += fmt::format("{} '{}' ", c == 0 ? "" : ";", cameras_[c].nominal.name);
        if (tally.num_pictures == 0) {
            text += "sent no picture";
        } else if (tally.background > kBright) {
            text += "is bright all over: shorten the exposure or darken the room";
        } else if (tally.num_with_lights == 0) {
            text += "saw no light: is it covered, or its exposure too long or too short?";
        } else {
            text += fmt::format(
                "saw moving lights in {} of {} pictures, and the whole wand with "
                "another camera in {}",
                tally.num_with_lights,
                tally.num_pictures,
                tally.num_instants);
        }
    }
    return text;
}

}  // namespace atrium::calibrate
