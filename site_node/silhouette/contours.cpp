#include "site_node/silhouette/contours.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace atrium::silhouette {
namespace {

// Directions of travel, in the order of left turns (seen with +Y up): +x, +y, -x, -y.
constexpr int kStepX[4] = {1, 0, -1, 0};
constexpr int kStepY[4] = {0, 1, 0, -1};

// The pixels left and right ahead of a pixel corner (x, y), which is the upper left corner of pixel
// (x, y).
constexpr int kLeftAheadX[4] = {0, -1, -1, 0};
constexpr int kLeftAheadY[4] = {0, 0, -1, -1};
constexpr int kRightAheadX[4] = {0, 0, -1, -1};
constexpr int kRightAheadY[4] = {-1, 0, 0, -1};

bool is_foreground(const image::Mask& mask, int x, int y) {
    return static_cast<unsigned>(x) < static_cast<unsigned>(mask.width) &&
           static_cast<unsigned>(y) < static_cast<unsigned>(mask.height) && mask.row(y)[x] != 0;
}

// Walks one contour from the crack above pixel (start_x, start_y), to the right.
Contour follow(const image::Mask& mask, int start_x, int start_y, ContourSet& out) {
    Contour contour;
    contour.begin = out.points.size();
    int x = start_x;
    int y = start_y;
    int direction = 0;
    do {
        if (direction == 0) {
            out.visited[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                        static_cast<std::size_t>(x)] = out.stamp;
        }
        // corner (x, y) is at pixel position (x - 0.5, y - 0.5), so the middle of the crack is at
        // half-pixels
        out.points.push_back({2 * x - 1 + kStepX[direction], 2 * y - 1 + kStepY[direction]});
        contour.area_px += static_cast<std::int64_t>(x) * kStepY[direction];  // Green's theorem
        const bool vertical = kStepY[direction] != 0;
        contour.touches_border |=
            vertical ? (x == 0 || x == mask.width) : (y == 0 || y == mask.height);
        x += kStepX[direction];
        y += kStepY[direction];
        if (!is_foreground(mask, x + kLeftAheadX[direction], y + kLeftAheadY[direction])) {
            direction = (direction + 1) & 3;
        } else if (is_foreground(mask, x + kRightAheadX[direction], y + kRightAheadY[direction])) {
            direction = (direction + 3) & 3;
        }
    } while (x != start_x || y != start_y || direction != 0);
    contour.size = out.points.size() - contour.begin;
    return contour;
}

// A walk around a hole begins at its lower side, in no special place: let the contour start at its
// lowest point.
void start_hole_at_lowest_point(const Contour& hole, std::vector<GridPoint>& points) {
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(hole.begin);
    const auto lowest = std::max_element(begin, points.end(), [](GridPoint a, GridPoint b) {
        return a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    std::rotate(begin, lowest, points.end());
}

void follow_if_new(
    const image::Mask& mask, int x, int y, std::int64_t min_area_px, ContourSet& out) {
    if (!is_foreground(mask, x, y) || is_foreground(mask, x, y - 1)) return;
    const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                              static_cast<std::size_t>(x);
    if (out.visited[pixel] == out.stamp) return;
    const Contour contour = follow(mask, x, y, out);
    if (std::abs(contour.area_px) < min_area_px) {
        ++out.num_small;
        out.points.resize(contour.begin);
        return;
    }
    if (contour.area_px < 0) start_hole_at_lowest_point(contour, out.points);
    out.contours.push_back(contour);
}

void begin_call(const image::Mask& mask, ContourSet& out) {
    out.contours.clear();
    out.points.clear();
    out.num_small = 0;
    ++out.stamp;
    if (out.stamp == 0 || out.visited.size() != mask.data.size()) {
        out.visited.assign(mask.data.size(), 0);
        out.stamp = 1;
    }
}

std::uint64_t load8(const std::uint8_t* bytes) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    return word;
}

constexpr int kBlock = 64;

// First of the columns x, x + kBlock, ... from which on a whole block is not there, or has a
// foreground pixel below background.
int skip_blocks_without_tops(const std::uint8_t* row, const std::uint8_t* above, int x, int width) {
    for (; x + kBlock <= width; x += kBlock) {
        std::uint64_t tops = 0;
        for (int i = x; i < x + kBlock; i += 8)
            tops |= above ? load8(row + i) & ~load8(above + i) : load8(row + i);
        if (tops != 0) break;
    }
    return x;
}

}  // namespace

void trace_contours(const image::Mask& mask, std::int64_t min_area_px, ContourSet& out) {
    assert(mask.data.size() ==
           static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
    begin_call(mask, out);
    for (int y = 0; y < mask.height; ++y) {
        const std::uint8_t* row = mask.row(y);
        const std::uint8_t* above = y > 0 ? mask.row(y - 1) : nullptr;
        int x = 0;
        while (x + kBlock <= mask.width) {
            x = skip_blocks_without_tops(row, above, x, mask.width);
            for (int end = std::min(x + kBlock, mask.width & ~7); x < end; x += 8) {
                const std::uint64_t tops =
                    above ? load8(row + x) & ~load8(above + x) : load8(row + x);
                if (tops == 0) continue;
                for (int i = 0; i < 8; ++i) follow_if_new(mask, x + i, y, min_area_px, out);
            }
        }
        for (; x < mask.width; ++x) follow_if_new(mask, x, y, min_area_px, out);
    }
}

image::PixelRect bounding_rect(const ContourSet& contours) {
    if (contours.points.empty()) return {};
    GridPoint low = contours.points.front();
    GridPoint high = low;
    for (const GridPoint p : contours.points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    // the outermost points are in the middle of cracks, which are at odd half-pixels: the one
    // before pixel x is 2 x - 1
    const int x = (low.x + 1) / 2;
    const int y = (low.y + 1) / 2;
    return {x, y, (high.x + 1) / 2 - x, (high.y + 1) / 2 - y};
}

}  // namespace atrium::silhouette
