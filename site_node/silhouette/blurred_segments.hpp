#pragma once

#include "site_node/silhouette/contours.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::silhouette {

/// Grows one blurred segment: accepts points while their convex hull is at most `thickness` thick.
///
/// The thickness is isothetic: the smaller of the longest vertical and the longest horizontal chord
/// of the hull. All decisions are exact (integers), and the limit itself is accepted.
///
/// Based on: Debled-Rennesson, Remy, Rouyer-Degli. Segmentation of Discrete Curves into Fuzzy
/// Segments (2003), and its successor on blurred segments of noisy curves; the hull is Melkman's
/// (1987). We differ in the thickness: by duality it is the least isothetic width of a strip along
/// one edge of the hull. We keep one strip as a witness and look for another only when a point
/// falls outside it.
class BlurredSegment {
public:
    BlurredSegment();

    /// Takes effect at the next restart; rounded down to 1/64 pixel.
    void set_thickness_px(double thickness_px);

    void restart(GridPoint first);

    /// Returns false if `point` would make the segment too thick; the segment then needs a restart.
    /// The points must form a path that does not cross itself.
    bool add(GridPoint point);

private:
    bool hull_add(GridPoint point);
    bool find_strip();

    static constexpr int kUnitsPerPixel = 64;
    std::int64_t limit_units_ = 0;  // of half pixels

    // strip: points p with 0 <= cross(strip_to - strip_from, p - strip_from) <= strip_limit
    GridPoint strip_from_;
    GridPoint strip_to_;
    std::int64_t strip_limit_ = 0;

    // Melkman's deque: hull_[bottom_ .. top_], left turns only, both ends are the same point; while
    // flat_, the two ends of a line
    std::vector<GridPoint> hull_;
    std::size_t bottom_ = 0;
    std::size_t top_ = 0;
    bool flat_ = true;
};

/// Appends to `breaks` the indices in [first, last) of `contour` at which its blurred segments
/// begin, starting with `first`. Indices are cyclic: `last` may be contour.size(), which is point
/// 0. Greedy, one pass.
void split_into_blurred_segments(std::span<const GridPoint> contour,
                                 std::size_t first,
                                 std::size_t last,
                                 BlurredSegment& segment,
                                 std::vector<std::uint32_t>& breaks);

}  // namespace atrium::silhouette
