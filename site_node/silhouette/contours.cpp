#include "site_node/silhouette/contours.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#if defined(__x86_64__)
#include <emmintrin.h>
#endif

namespace atrium::silhouette {
namespace {

// Directions of travel, in the order of left turns (with +Y up): +x, +y, -x, -y.
constexpr int kStepX[4] = {1, 0, -1, 0};
constexpr int kStepY[4] = {0, 1, 0, -1};

// Pixels ahead on the left and right of a pixel corner (x, y), the upper left corner of pixel (x,
// y).
constexpr int kLeftAheadX[4] = {0, -1, -1, 0};
constexpr int kLeftAheadY[4] = {0, 0, -1, -1};
constexpr int kRightAheadX[4] = {0, 0, -1, -1};
constexpr int kRightAheadY[4] = {-1, 0, 0, -1};

bool is_foreground(const image::Mask& mask, int x, int y) {
    return static_cast<unsigned>(x) < static_cast<unsigned>(mask.width) &&
           static_cast<unsigned>(y) < static_cast<unsigned>(mask.height) && mask.row(y)[x] != 0;
}

// Follows one contour from the crack above pixel (start_x, start_y), to the right.
Contour follow(const image::Mask& mask, int start_x, int start_y, ContourSet& out) {
    Contour contour;
    contour.begin = out.points.size();
    const std::ptrdiff_t width = mask.width;
    // offsets to the pixels ahead, from the pixel whose upper left corner is reached
    std::array<std::ptrdiff_t, 4> left_ahead;
    std::array<std::ptrdiff_t, 4> right_ahead;
    for (std::size_t d = 0; d < 4; ++d) {
        left_ahead[d] = kLeftAheadY[d] * width + kLeftAheadX[d];
        right_ahead[d] = kRightAheadY[d] * width + kRightAheadX[d];
    }
    const std::uint8_t* const pixels = mask.data.data();
    const auto inner_width = static_cast<unsigned>(mask.width - 1);
    const auto inner_height = static_cast<unsigned>(mask.height - 1);
    std::int64_t area_px = 0;
    bool touches_border = false;
    int x = start_x;
    int y = start_y;
    std::size_t direction = 0;
    do {
        const std::ptrdiff_t corner = y * width + x;
        if (direction == 0) out.visited[static_cast<std::size_t>(corner)] = out.stamp;
        // corner (x, y) is at pixel position (x - 0.5, y - 0.5): the crack's middle is at
        // half-pixels
        const int step_x = kStepX[direction];
        const int step_y = kStepY[direction];
        out.points.push_back({2 * x - 1 + step_x, 2 * y - 1 + step_y});
        area_px += static_cast<std::int64_t>(x) * step_y;  // Green's theorem
        x += step_x;
        y += step_y;
        // inside the picture all four pixels around a corner exist
        const bool is_inside = static_cast<unsigned>(x - 1) < inner_width &&
                               static_cast<unsigned>(y - 1) < inner_height;
        bool left = false;
        bool right = false;
        if (is_inside) {
            const std::uint8_t* const around = pixels + y * width + x;
            left = around[left_ahead[direction]] != 0;
            right = around[right_ahead[direction]] != 0;
        } else {
            left = is_foreground(mask, x + kLeftAheadX[direction], y + kLeftAheadY[direction]);
            right = is_foreground(mask, x + kRightAheadX[direction], y + kRightAheadY[direction]);
            touches_border |=
                step_y != 0 ? (x == 0 || x == mask.width) : (y == 0 || y == mask.height);
        }
        // to the left, straight on or to the right
        direction = (direction + (left ? (right ? 3U : 0U) : 1U)) & 3U;
    } while (x != start_x || y != start_y || direction != 0);
    contour.size = out.points.size() - contour.begin;
    contour.area_px = area_px;
    contour.touches_border = touches_border;
    return contour;
}

// Rotates a hole's contour to start at its lowest point: the walk began at an arbitrary one.
void start_hole_at_lowest_point(const Contour& hole, std::vector<GridPoint>& points) {
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(hole.begin);
    const auto lowest = std::max_element(begin, points.end(), [](GridPoint a, GridPoint b) {
        return a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    std::rotate(begin, lowest, points.end());
}

// Follows the contour at (x, y), a foreground pixel below background, unless it was visited.
void follow_if_new(
    const image::Mask& mask, int x, int y, std::int64_t min_area_px, ContourSet& out) {
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

constexpr int kBlock = 64;

// Returns one bit per pixel of [x, end), at most 64, the leftmost lowest: foreground below
// background. `above` is null for the top row.
std::uint64_t tops_of(const std::uint8_t* row, const std::uint8_t* above, int x, int end) {
    std::uint64_t tops = 0;
#if defined(__x86_64__)
    const auto load = [](const std::uint8_t* bytes) {
        return _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes));
    };
    if (end - x == kBlock) {
        for (int i = 0; i < kBlock; i += 16) {
            const __m128i here = load(row + x + i);
            const __m128i below =
                above != nullptr ? _mm_andnot_si128(load(above + x + i), here) : here;
            tops |= static_cast<std::uint64_t>(static_cast<unsigned>(_mm_movemask_epi8(below)))
                    << i;
        }
        return tops;
    }
#endif
    for (int i = x; i < end; ++i) {
        const bool is_top = row[i] != 0 && (above == nullptr || above[i] == 0);
        tops |= static_cast<std::uint64_t>(is_top) << (i - x);
    }
    return tops;
}

}  // namespace

void trace_contours(const image::Mask& mask,
                    std::int64_t min_area_px,
                    ContourSet& out,
                    std::span<const image::PixelSpan> rows) {
    assert(mask.data.size() ==
           static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
    assert(rows.empty() || rows.size() == static_cast<std::size_t>(mask.height));
    begin_call(mask, out);
    for (int y = 0; y < mask.height; ++y) {
        const std::uint8_t* row = mask.row(y);
        const std::uint8_t* above = y > 0 ? mask.row(y - 1) : nullptr;
        const image::PixelSpan span =
            rows.empty() ? image::PixelSpan{0, mask.width} : rows[static_cast<std::size_t>(y)];
        for (int x = span.begin; x < span.end; x += kBlock) {
            const int end = std::min(x + kBlock, span.end);
            std::uint64_t tops = tops_of(row, above, x, end);
            for (; tops != 0; tops &= tops - 1)
                follow_if_new(mask, x + std::countr_zero(tops), y, min_area_px, out);
        }
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
    // the outermost points are middles of cracks, at odd half-pixels: the crack before pixel x is
    // at 2 x - 1
    const int x = (low.x + 1) / 2;
    const int y = (low.y + 1) / 2;
    return {x, y, (high.x + 1) / 2 - x, (high.y + 1) / 2 - y};
}

}  // namespace atrium::silhouette
