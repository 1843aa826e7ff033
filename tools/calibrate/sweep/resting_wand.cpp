#include "tools/calibrate/sweep/resting_wand.hpp"

#include "core/base/median.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kInstants = 15;  // at each place
constexpr std::size_t kLinePlaces = 3;
constexpr double kWandRests_px = 1.0;       // how far lights move between instants
constexpr double kOtherPlace = 1.0 / 20.0;  // of a picture's width
constexpr std::size_t kMostSpots = 24;      // what the labeller looks at

}  // namespace

Expected<RestingWand> RestingWand::make(const Wand& wand, std::vector<NominalCamera> cameras) {
    auto labeller = LightLabeller::make(wand);
    if (!labeller || wand.form() == WandForm::kPoint)
        return make_error(ErrorKind::kConfiguration,
                          "a floor from pictures needs a wand whose lights can be told apart: "
                          "three or more on a line with distances that differ from both ends, or a "
                          "flat shape that looks different turned; or --points of lights with "
                          "numbers");
    const std::size_t num_needed = wand.form() == WandForm::kLine ? kLinePlaces : 1;
    return RestingWand(std::move(*labeller), std::move(cameras), num_needed, wand.size());
}

RestingWand::RestingWand(LightLabeller labeller,
                         std::vector<NominalCamera> cameras,
                         std::size_t num_needed,
                         std::size_t num_lights)
    : labeller_(std::move(labeller)),
      cameras_(std::move(cameras)),
      num_needed_(num_needed),
      num_lights_(num_lights),
      wand_px_(cameras_.size()) {
    for (const NominalCamera& camera : cameras_) points_.push_back({camera.name, {}});
}

void RestingWand::add(const std::vector<std::optional<DetectedLights>>& seen) {
    std::size_t num_seeing = 0;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        wand_px_[c].clear();
        if (!seen[c]) continue;
        std::vector<Eigen::Vector2d> spots;
        for (const DetectedLight& light : seen[c]->lights)
            if (spots.size() < kMostSpots) spots.push_back(light.px);
        const auto labels = labeller_.label(spots);
        if (spots.size() >= num_lights_) ++(labels ? num_like_ : num_unlike_);
        if (!labels) continue;
        for (const std::size_t i : *labels) wand_px_[c].push_back(spots[i]);
        ++num_seeing;
    }
    if (!resting_.empty() && has_moved(resting_.back(), kWandRests_px)) resting_.clear();
    if (num_seeing < 2 || is_complete()) return;
    const double elsewhere_px = kOtherPlace * cameras_.front().width;
    if (!placed_.empty() && !has_moved(placed_, elsewhere_px)) return;
    resting_.push_back(wand_px_);
    if (resting_.size() == kInstants) take_place();
}

bool RestingWand::has_moved(const std::vector<std::vector<Eigen::Vector2d>>& before,
                            double most_px) const {
    bool is_comparable = false;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        const std::size_t num = std::min(wand_px_[c].size(), before[c].size());
        is_comparable = is_comparable || num > 0;
        for (std::size_t light = 0; light < num; ++light)
            if ((wand_px_[c][light] - before[c][light]).norm() > most_px) return true;
    }
    return !is_comparable;
}

void RestingWand::take_place() {
    const auto instant = static_cast<std::uint32_t>(num_places_++);
    placed_.assign(cameras_.size(), {});
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        std::vector<std::vector<double>> xs, ys;  // per light
        for (const auto& at : resting_) {
            xs.resize(std::max(xs.size(), at[c].size()));
            ys.resize(xs.size());
            for (std::size_t light = 0; light < at[c].size(); ++light) {
                xs[light].push_back(at[c][light].x());
                ys[light].push_back(at[c][light].y());
            }
        }
        // a camera that saw it a few times may have taken something else for it
        if (xs.empty() || 2 * xs.front().size() < kInstants) continue;
        for (std::size_t light = 0; light < xs.size(); ++light) {
            placed_[c].emplace_back(median_of(xs[light]), median_of(ys[light]));
            points_[c].points.push_back(
                {instant, static_cast<std::uint32_t>(light), placed_[c].back()});
        }
    }
    resting_.clear();
}

std::string RestingWand::progress() const {
    std::string text = fmt::format("floor: {} of {} places", num_places_, num_needed_);
    if (is_complete()) return text;
    if (sees_other_wand())
        return fmt::format(
            "{}; {} pictures show {} lights or more, but none at the distances that "
            "the wand has: is --wand the file of this wand?",
            text,
            num_unlike_,
            num_lights_);
    if (resting_.empty())
        return text + (num_places_ == 0
                           ? "; lay the wand down where two cameras see it"
                           : "; lay it down at another place, which makes a triangle of them");
    std::vector<std::string> seeing;
    for (std::size_t c = 0; c < cameras_.size(); ++c)
        if (!resting_.back()[c].empty()) seeing.push_back(cameras_[c].name);
    return fmt::format("{}; the wand rests before {}: {} of {} instants",
                       text,
                       fmt::join(seeing, ", "),
                       resting_.size(),
                       kInstants);
}

}  // namespace atrium::calibrate
