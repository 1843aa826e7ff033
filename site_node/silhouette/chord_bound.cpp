#include "site_node/silhouette/chord_bound.hpp"

#include <cassert>
#include <cmath>

namespace atrium::silhouette {
namespace {

__extension__ typedef __int128 Int128;

constexpr std::int64_t kUnitsPerGridStep = kUnitsPerPixel / 2;  // GridPoint counts half pixels

struct Units {
    std::int64_t x;
    std::int64_t y;
};

Units units_of(const Eigen::Vector2d& px) {
    // exact: grid coordinates are multiples of a power of two
    return {static_cast<std::int64_t>(px.x() * kUnitsPerPixel),
            static_cast<std::int64_t>(px.y() * kUnitsPerPixel)};
}

// Returns the largest integer whose square is at most `factor`^2 * `square`.
std::int64_t floor_of_root(std::int64_t factor, std::int64_t square) {
    const Int128 limit = static_cast<Int128>(factor * factor) * square;
    auto root = static_cast<std::int64_t>(static_cast<double>(factor) *
                                          std::sqrt(static_cast<double>(square)));
    while (static_cast<Int128>(root) * root > limit) --root;
    while (static_cast<Int128>(root + 1) * (root + 1) <= limit) ++root;
    return root;
}

}  // namespace

Eigen::Vector2d snapped_px(GridPoint origin, const Eigen::Vector2d& offset_px) {
    constexpr double kStep_px = 1.0 / kUnitsPerPixel;
    return {0.5 * origin.x + kStep_px * std::nearbyint(offset_px.x() * kUnitsPerPixel),
            0.5 * origin.y + kStep_px * std::nearbyint(offset_px.y() * kUnitsPerPixel)};
}

std::int64_t tolerance_units(double tolerance_px) {
    constexpr int kFractions = 64;
    static_assert(kUnitsPerPixel % kFractions == 0);
    return static_cast<std::int64_t>(std::floor(tolerance_px * kFractions)) *
           (kUnitsPerPixel / kFractions);
}

bool all_within(std::span<const GridPoint> contour,
                std::size_t begin,
                std::size_t end,
                const Eigen::Vector2d& a_px,
                const Eigen::Vector2d& b_px,
                std::int64_t tolerance) {
    assert(begin <= end && end <= contour.size());
    const Units a = units_of(a_px);
    const Units b = units_of(b_px);
    const Units along{b.x - a.x, b.y - a.y};
    const std::int64_t length_sq = along.x * along.x + along.y * along.y;
    const std::int64_t tolerance_sq = tolerance * tolerance;
    // on the cross product, for points beside the line segment
    const std::int64_t limit = floor_of_root(tolerance, length_sq);
    for (std::size_t i = begin; i <= end; ++i) {
        const GridPoint point = contour[i == contour.size() ? 0 : i];
        const std::int64_t x = point.x * kUnitsPerGridStep - a.x;
        const std::int64_t y = point.y * kUnitsPerGridStep - a.y;
        const std::int64_t dot = along.x * x + along.y * y;
        if (dot > 0 && dot < length_sq) {
            if (std::abs(along.x * y - along.y * x) > limit) return false;
            continue;
        }
        const std::int64_t from_x = dot <= 0 ? x : x - along.x;
        const std::int64_t from_y = dot <= 0 ? y : y - along.y;
        if (from_x * from_x + from_y * from_y > tolerance_sq) return false;
    }
    return true;
}

}  // namespace atrium::silhouette
