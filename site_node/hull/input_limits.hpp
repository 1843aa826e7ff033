#pragma once

#include <cstddef>

namespace atrium::hull {

/// What `compute_visual_hull` takes, besides `kMaxViews` and the limits in HullOptions
/// (docs/design/hull.md, "Limits"): for whoever wants to say beforehand what is beyond them.

inline constexpr std::size_t kViewsOfBounds = 2;  // as so many views HullOptions::bounds count
inline constexpr double kMinFocal_px = 1e-3;      // rays stay far from what doubles can hold,
inline constexpr double kMaxFocal_px = 1e7;  // and the grid on which they end finer than 1e-3 px
/// Points of all contours and fields, times the number of views: each point's ray is kept for each
/// other view, 250 MB in all.
inline constexpr std::size_t kMaxPointsTimesViews = 4'000'000;
inline constexpr std::size_t kMaxContours = 2000;  // of one view; nesting is tested pairwise

}  // namespace atrium::hull
