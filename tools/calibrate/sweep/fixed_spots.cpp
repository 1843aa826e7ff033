#include "tools/calibrate/sweep/fixed_spots.hpp"

#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kCell_px = 4.0;
constexpr double kSamePlace_px = 1.5;
constexpr std::uint32_t kFewest = 10;  // pictures
constexpr double kShareSoFar = 0.5, kShareAtEnd = 0.25;

std::pair<int, int> cell_of(const Eigen::Vector2d& px) {
    return {static_cast<int>(std::floor(px.x() / kCell_px)),
            static_cast<int>(std::floor(px.y() / kCell_px))};
}

}  // namespace

std::optional<std::size_t> FixedSpots::place_at(const Eigen::Vector2d& px) const {
    const auto [cx, cy] = cell_of(px);
    std::optional<std::size_t> nearest;
    double least = kSamePlace_px;
    for (int y = cy - 1; y <= cy + 1; ++y) {
        for (int x = cx - 1; x <= cx + 1; ++x) {
            const auto [begin, end] = by_cell_.equal_range({x, y});
            for (auto it = begin; it != end; ++it) {
                const double distance = (places_[it->second].px - px).norm();
                if (distance > least) continue;
                least = distance;
                nearest = it->second;
            }
        }
    }
    return nearest;
}

bool FixedSpots::is_often(const Place& place, double share) const {
    return place.num_seen >= kFewest &&
           place.num_seen >= share * static_cast<double>(num_pictures_ - place.first);
}

std::vector<bool> FixedSpots::add(const std::vector<Eigen::Vector2d>& spots_px) {
    const std::uint32_t picture = num_pictures_++;
    std::vector<bool> fixed;
    for (const Eigen::Vector2d& px : spots_px) {
        const auto found = place_at(px);
        if (!found) {
            by_cell_.insert({cell_of(px), places_.size()});
            places_.push_back({px, picture, picture, 1});
            fixed.push_back(false);
            continue;
        }
        Place& place = places_[*found];
        // once per picture, whatever is near
        if (place.last != picture) ++place.num_seen;
        place.last = picture;
        fixed.push_back(is_often(place, kShareSoFar));
    }
    return fixed;
}

bool FixedSpots::is_fixed(const Eigen::Vector2d& px) const {
    const auto found = place_at(px);
    return found && is_often(places_[*found], kShareAtEnd);
}

}  // namespace atrium::calibrate
