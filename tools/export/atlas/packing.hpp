#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

namespace atrium::exporting {

struct Packing {
    Eigen::Vector2i size = Eigen::Vector2i::Zero();  // multiples of 16; as square as they come out
    std::vector<Eigen::Vector2i> places;             // upper left corners, as the rectangles
};

/// Packs rectangles without rotation by the skyline method: the tallest first, each where its
/// bottom comes out lowest. Deterministic.
///
/// After: Jylänki. A Thousand Ways to Pack the Bin. 2010 (SKYLINE-BL).
Packing pack(std::span<const Eigen::Vector2i> rectangles);

}  // namespace atrium::exporting
