#pragma once

#include <cstddef>

namespace atrium::hull {

/// Input limits of `compute_visual_hull`, besides `kMaxViews` and the limits in HullOptions, for
/// callers that check beforehand. See docs/design/hull.md, "Limits".

inline constexpr std::size_t kViewsOfBounds = 2;  // HullOptions::bounds counts as this many views
inline constexpr double kMinFocal_px = 1e-3;      // keeps rays far from the range of doubles,
inline constexpr double kMaxFocal_px = 1e6;       // and the grid of the rays finer than 1e-3 px
/// Limit on (points of all contours and fields) * (number of views): each ray is stored once per
/// other view, 250 MB in all.
inline constexpr std::size_t kMaxPointsTimesViews = 4'000'000;
inline constexpr std::size_t kMaxContours = 2000;  // per view; nesting is tested for all pairs

}  // namespace atrium::hull
