#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace atrium::calibrate {

/// Tells lamps and reflections that stay where they are from the lights of a wand that moves. Of
/// one camera.
class FixedSpots {
public:
    /// Takes the spots of the next picture. Returns for each whether it seems to be fixed by now:
    /// it was at this place in ten pictures, and in half of those since it was first seen.
    std::vector<bool> add(const std::vector<Eigen::Vector2d>& spots_px);

    /// True if a spot was at this place in ten pictures and in a quarter of those since it was
    /// first seen. Ask at the end of a sweep: a wand that rested for a while is not fixed.
    bool is_fixed(const Eigen::Vector2d& px) const;

private:
    struct Place {
        Eigen::Vector2d px = Eigen::Vector2d::Zero();
        std::uint32_t first = 0;  // number of the picture
        std::uint32_t last = 0;
        std::uint32_t num_seen = 0;
    };
    using Cell = std::pair<int, int>;
    std::optional<std::size_t> place_at(const Eigen::Vector2d& px) const;
    bool is_often(const Place& place, double share) const;

    std::vector<Place> places_;
    std::multimap<Cell, std::size_t> by_cell_;
    std::uint32_t num_pictures_ = 0;
};

}  // namespace atrium::calibrate
