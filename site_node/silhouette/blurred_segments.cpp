#include "site_node/silhouette/blurred_segments.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::silhouette {
namespace {

// Positive if a, b, c turn left (with +Y up).
std::int64_t turn(GridPoint a, GridPoint b, GridPoint c) {
    return static_cast<std::int64_t>(b.x - a.x) * (c.y - a.y) -
           static_cast<std::int64_t>(b.y - a.y) * (c.x - a.x);
}

// Of the deque; hulls of straight parts have fewer than 20 corners.
constexpr std::size_t kInitialCapacity = 256;

}  // namespace

BlurredSegment::BlurredSegment() : hull_(kInitialCapacity) {}

void BlurredSegment::set_thickness_px(double thickness_px) {
    assert(thickness_px >= 0.0);
    // the grid has half pixels
    limit_units_ = 2 * static_cast<std::int64_t>(std::floor(thickness_px * kUnitsPerPixel));
}

void BlurredSegment::restart(GridPoint first) {
    bottom_ = top_ = hull_.size() / 2;
    hull_[bottom_] = first;
    flat_ = true;
    strip_from_ = strip_to_ = first;
    strip_limit_ = -1;  // no strip yet
}

bool BlurredSegment::add(GridPoint point) {
    const bool hull_changed = hull_add(point);
    if (!hull_changed || flat_) return true;
    const std::int64_t side = turn(strip_from_, strip_to_, point);
    if (side >= 0 && side * kUnitsPerPixel <= strip_limit_) return true;
    return find_strip();
}

// Returns true if the hull changed.
bool BlurredSegment::hull_add(GridPoint point) {
    if (flat_) {
        if (bottom_ == top_) {
            hull_[++top_] = point;
            return true;
        }
        const std::int64_t side = turn(hull_[bottom_], hull_[top_], point);
        if (side == 0) {
            hull_[top_] = point;  // a path that does not cross itself continues in its direction
            return true;
        }
        const GridPoint first = hull_[bottom_];
        const GridPoint second = hull_[top_];
        hull_[bottom_] = point;
        hull_[bottom_ + 1] = side > 0 ? first : second;
        hull_[bottom_ + 2] = side > 0 ? second : first;
        hull_[bottom_ + 3] = point;
        top_ = bottom_ + 3;
        flat_ = false;
        return true;
    }
    std::int64_t side_of_bottom = turn(hull_[bottom_], hull_[bottom_ + 1], point);
    std::int64_t side_of_top = turn(hull_[top_ - 1], hull_[top_], point);
    if (side_of_bottom >= 0 && side_of_top >= 0) return false;
    // grow the deque around its middle before it runs out at an end
    if (bottom_ == 0 || top_ + 1 == hull_.size()) {
        std::vector<GridPoint> larger(hull_.size() * 2);
        const std::size_t size = top_ - bottom_ + 1;
        const std::size_t begin = (larger.size() - size) / 2;
        std::copy_n(hull_.begin() + static_cast<std::ptrdiff_t>(bottom_),
                    size,
                    larger.begin() + static_cast<std::ptrdiff_t>(begin));
        hull_.swap(larger);
        bottom_ = begin;
        top_ = begin + size - 1;
    }
    GridPoint* bottom = hull_.data() + bottom_;
    GridPoint* top = hull_.data() + top_;
    while (top - bottom > 1 && side_of_bottom <= 0) {
        ++bottom;
        side_of_bottom = turn(bottom[0], bottom[1], point);
    }
    *--bottom = point;
    while (top - bottom > 1 && side_of_top <= 0) {
        --top;
        side_of_top = turn(top[-1], top[0], point);
    }
    *++top = point;
    bottom_ = static_cast<std::size_t>(bottom - hull_.data());
    top_ = static_cast<std::size_t>(top - hull_.data());
    return true;
}

// Looks for a hull edge along which the whole hull fits into a sufficiently thin strip.
bool BlurredSegment::find_strip() {
    const GridPoint* const hull = hull_.data() + bottom_;
    const std::size_t num_edges = top_ - bottom_;
    for (std::size_t edge = 0; edge < num_edges; ++edge) {
        const GridPoint from = hull[edge];
        const GridPoint to = hull[edge + 1];
        const std::int64_t longer = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y));
        const std::int64_t limit = limit_units_ * longer;
        bool fits = true;
        for (std::size_t corner = 0; corner < num_edges && fits; ++corner)
            fits = turn(from, to, hull[corner]) * kUnitsPerPixel <= limit;
        if (!fits) continue;
        strip_from_ = from;
        strip_to_ = to;
        strip_limit_ = limit;
        return true;
    }
    return false;
}

void split_into_blurred_segments(std::span<const GridPoint> contour,
                                 std::size_t first,
                                 std::size_t last,
                                 BlurredSegment& segment,
                                 std::vector<std::uint32_t>& breaks) {
    assert(first < last && last <= contour.size());
    breaks.push_back(static_cast<std::uint32_t>(first));
    segment.restart(contour[first]);
    for (std::size_t i = first + 1; i <= last; ++i) {
        const GridPoint point = contour[i == contour.size() ? 0 : i];
        if (segment.add(point)) continue;
        // two neighbours always form a segment, so each restart advances
        breaks.push_back(static_cast<std::uint32_t>(i - 1));
        segment.restart(contour[i - 1]);
        segment.add(point);
    }
}

}  // namespace atrium::silhouette
