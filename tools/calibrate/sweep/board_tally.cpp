#include "tools/calibrate/sweep/board_tally.hpp"

#include "core/base/median.hpp"
#include "tools/calibrate/board/leaning.hpp"
#include "tools/calibrate/sweep/sweep_progress.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr double kNewPlace = 1.0 / 40.0;  // of the picture's width: how far corners have moved
constexpr double kLeans = 1.12;           // leaning_of a board that counts as tilted
constexpr std::size_t kLeastCommon = 4;   // corners that tell how far a board has moved
constexpr std::size_t kMostSamples = 3;   // of a camera
constexpr double kSilent_s = 5.0, kWarnAgain_s = 20.0;

}  // namespace

BoardTally::BoardTally(std::vector<Board> boards,
                       std::vector<NominalCamera> cameras,
                       const BoardNeeds& needs)
    : boards_(std::move(boards)),
      cameras_(std::move(cameras)),
      needs_(needs),
      films_(cameras_.size()),
      placed_(cameras_.size()),
      last_picture_s_(cameras_.size()),
      warned_s_(cameras_.size()),
      links_(cameras_.size()) {
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        tallies_.emplace_back(cameras_[c]);
        films_[c].camera.name = cameras_[c].name;
        films_[c].camera.width = cameras_[c].width;
        films_[c].camera.height = cameras_[c].height;
    }
}

void BoardTally::add(std::uint32_t instant,
                     double time_s,
                     const std::vector<std::optional<Detection>>& seen) {
    std::vector<std::size_t> seeing;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        tallies_[c].corners = seen[c] ? seen[c]->corners : std::vector<SeenCorner>{};
        if (seen[c] || !last_picture_s_[c]) last_picture_s_[c] = time_s;
        if (seen[c]) {
            films_[c].count(*seen[c]);
        } else if (time_s - *last_picture_s_[c] >= kSilent_s &&
                   (!warned_s_[c] || time_s - *warned_s_[c] >= kWarnAgain_s)) {
            warned_s_[c] = time_s;
            warnings_.push_back(fmt::format("camera '{}' sends no pictures", name(c)));
        }
        if (tallies_[c].corners.empty()) continue;
        seeing.push_back(c);
    }
    const bool is_new = std::ranges::any_of(
        seeing, [&](std::size_t c) { return has_moved(c) && adds(c, seeing.size() > 1); });
    const std::vector<std::size_t> apart = links_.unlinked(needs_.num_shared);
    const bool links_more = seeing.size() > 1 && std::ranges::any_of(seeing, [&](std::size_t c) {
                                return has_moved(c) && std::ranges::find(apart, c) != apart.end();
                            });
    if (is_new || links_more) keep(instant, seen);
}

void BoardTally::keep(std::uint32_t instant, const std::vector<std::optional<Detection>>& seen) {
    std::vector<std::size_t> seeing;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        BoardCameraTally& tally = tallies_[c];
        if (tally.corners.empty()) continue;
        seeing.push_back(c);
        films_[c].keep(instant, *seen[c]);
        for (const SeenCorner& corner : tally.corners) tally.covered.cover(corner.px);
    }
    for (const std::size_t c : seeing) {
        if (!has_moved(c)) continue;
        BoardCameraTally& tally = tallies_[c];
        ++tally.num_places;
        tally.num_tilted += leaning_of(boards_, tally.corners) >= kLeans ? 1 : 0;
        tally.num_shared += seeing.size() > 1 ? 1 : 0;
        placed_[c] = tally.corners;
    }
    links_.count(seeing);
}

// Against the place that was counted last.
bool BoardTally::has_moved(std::size_t c) const {
    std::vector<double> moved_px;
    for (const SeenCorner& now : tallies_[c].corners) {
        const auto before = std::ranges::find(placed_[c], now.corner, &SeenCorner::corner);
        if (before != placed_[c].end()) moved_px.push_back((now.px - before->px).norm());
    }
    return moved_px.size() < kLeastCommon ||
           median_of(std::move(moved_px)) >= kNewPlace * cameras_[c].width;
}

bool BoardTally::has_enough(std::size_t c) const {
    const BoardCameraTally& tally = tallies_[c];
    return tally.num_places >= needs_.num_places && tally.num_tilted >= needs_.num_tilted &&
           tally.num_shared >= needs_.num_shared && tally.covered.share() >= needs_.coverage;
}

// True if a new place helps this camera: when it has many, only what it still lacks.
bool BoardTally::adds(std::size_t c, bool is_shared) const {
    const BoardCameraTally& tally = tallies_[c];
    if (has_enough(c)) return false;
    if (tally.num_places < 2 * needs_.num_places) return true;
    const bool covers = std::ranges::any_of(tally.corners, [&](const SeenCorner& corner) {
        return !tally.covered.is_covered(corner.px);
    });
    return (covers && tally.covered.share() < needs_.coverage) ||
           (is_shared && tally.num_shared < needs_.num_shared) ||
           (tally.num_tilted < needs_.num_tilted && leaning_of(boards_, tally.corners) >= kLeans);
}

bool BoardTally::is_complete() const {
    for (std::size_t c = 0; c < cameras_.size(); ++c)
        if (!has_enough(c)) return false;
    return links_.unlinked(needs_.num_shared).empty();
}

std::string BoardTally::need_of(std::size_t c) const {
    const BoardCameraTally& tally = tallies_[c];
    if (has_enough(c)) return {};
    if (tally.num_places < needs_.num_places)
        return fmt::format("{} of {} places, show it {}",
                           tally.num_places,
                           needs_.num_places,
                           tally.covered.emptiest_part());
    if (tally.covered.share() < needs_.coverage)
        return fmt::format("{:.0f} of {:.0f} % of its picture, show it {}",
                           100.0 * tally.covered.share(),
                           100.0 * needs_.coverage,
                           tally.covered.emptiest_part());
    if (tally.num_tilted < needs_.num_tilted)
        return fmt::format("tilted {} of {} times, tilt it more or come nearer",
                           tally.num_tilted,
                           needs_.num_tilted);
    return fmt::format("with another camera {} of {} times", tally.num_shared, needs_.num_shared);
}

std::string BoardTally::progress(std::size_t most_characters) const {
    std::vector<std::size_t> needy;
    std::vector<std::string> enough;
    for (std::size_t c = 0; c < cameras_.size(); ++c)
        has_enough(c) ? enough.push_back(name(c)) : needy.push_back(c);
    std::ranges::stable_sort(needy, {}, [this](std::size_t c) { return tallies_[c].num_places; });
    std::vector<std::string> parts;
    for (const std::size_t c : needy) parts.push_back(fmt::format("{}: {}", name(c), need_of(c)));
    if (needy.empty()) {
        std::vector<std::string> apart;
        for (const std::size_t c : links_.unlinked(needs_.num_shared)) apart.push_back(name(c));
        if (!apart.empty())
            parts.push_back(fmt::format("hold it where {} and the others see it at once",
                                        fmt::join(apart, ", ")));
    }
    if (!enough.empty()) parts.push_back(fmt::format("enough: {}", fmt::join(enough, ", ")));
    return progress_line(fmt::format("boards: {} of {} cameras", enough.size(), cameras_.size()),
                         parts,
                         most_characters);
}

void BoardTally::sample(std::size_t c, GrayPicture picture) {
    std::vector<GrayPicture>& samples = films_[c].samples;
    if (samples.size() == kMostSamples) samples.erase(samples.begin());
    samples.push_back(std::move(picture));
}

std::vector<std::string> BoardTally::take_warnings() { return std::exchange(warnings_, {}); }

}  // namespace atrium::calibrate
