#include "tools/calibrate/sweep/resting_board.hpp"

#include "core/base/median.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kNeeded = 20;
constexpr double kRests_px = 1.0;  // how far the median corner moves between instants

bool sees(const std::optional<Detection>& seen) { return seen && !seen->corners.empty(); }

// A camera that sees the board now and then, such as from far away, tells nothing then.
bool has_moved(const std::optional<Detection>& before, const std::optional<Detection>& now) {
    if (!sees(before) || !sees(now)) return false;
    std::vector<double> moved_px;
    for (const SeenCorner& corner : now->corners) {
        const auto same = std::ranges::find(before->corners, corner.corner, &SeenCorner::corner);
        if (same != before->corners.end()) moved_px.push_back((same->px - corner.px).norm());
    }
    return median_of(std::move(moved_px)) > kRests_px;
}

}  // namespace

RestingBoard::RestingBoard(std::vector<NominalCamera> cameras) : cameras_(std::move(cameras)) {}

void RestingBoard::add(std::uint32_t instant, const std::vector<std::optional<Detection>>& seen) {
    const bool is_in_sight = std::ranges::any_of(seen, sees);
    bool rests = is_in_sight;
    for (std::size_t c = 0; rests && !resting_.empty() && c < seen.size(); ++c)
        rests = !has_moved(resting_.back().seen[c], seen[c]);
    if (!rests) resting_.clear();
    if (!is_in_sight) return;
    resting_.push_back({instant, seen});
    if (resting_.size() > kNeeded) resting_.pop_front();
}

bool RestingBoard::is_complete() const { return resting_.size() == kNeeded; }

std::string RestingBoard::progress() const {
    std::vector<std::string> seeing;
    for (std::size_t c = 0; !resting_.empty() && c < cameras_.size(); ++c)
        if (sees(resting_.back().seen[c])) seeing.push_back(cameras_[c].name);
    if (seeing.empty()) return "floor: no camera sees the board";
    return fmt::format("floor: {} {} the board at rest: {} of {} instants",
                       fmt::join(seeing, ", "),
                       seeing.size() == 1 ? "sees" : "see",
                       resting_.size(),
                       kNeeded);
}

std::vector<FilmedCamera> RestingBoard::films() const {
    std::vector<FilmedCamera> films(cameras_.size());
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        films[c].camera.name = cameras_[c].name;
        films[c].camera.width = cameras_[c].width;
        films[c].camera.height = cameras_[c].height;
        for (const Instant& instant : resting_) {
            if (!instant.seen[c]) continue;
            films[c].count(*instant.seen[c]);
            films[c].keep(instant.number, *instant.seen[c]);
        }
    }
    return films;
}

}  // namespace atrium::calibrate
