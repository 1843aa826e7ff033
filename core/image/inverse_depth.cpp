#include "core/image/inverse_depth.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__x86_64__)
#define ATRIUM_AVX2 __attribute__((target("avx2")))
#endif
#define ATRIUM_INLINE inline __attribute__((always_inline))

namespace atrium::image {
namespace {

// Pixels of a row drawn at once, in one or two registers.
constexpr int kLanes = 8;
using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));
constexpr Ints kSteps = {0, 1, 2, 3, 4, 5, 6, 7};

using Four = float __attribute__((vector_size(16)));

// Eight triangles, one per lane. Passed by reference, because vectors by value have no stable ABI.
struct Corners {
    Floats x, y, z;
};

ATRIUM_INLINE void load_two(const Eigen::Vector4f& low, const Eigen::Vector4f& high, Floats& out) {
    Four a, b;
    std::memcpy(&a, low.data(), sizeof a);
    std::memcpy(&b, high.data(), sizeof b);
    out = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}

// Loads corner `i` of eight triangles: a transposition without the unused component.
ATRIUM_INLINE void gather(std::span<const Eigen::Vector4f> corners,
                          const std::array<std::uint32_t, 3>* triangles,
                          std::size_t i,
                          Corners& out) {
    Floats p, q, r, s;
    load_two(corners[triangles[0][i]], corners[triangles[4][i]], p);
    load_two(corners[triangles[1][i]], corners[triangles[5][i]], q);
    load_two(corners[triangles[2][i]], corners[triangles[6][i]], r);
    load_two(corners[triangles[3][i]], corners[triangles[7][i]], s);
    const Floats pq = __builtin_shufflevector(p, q, 0, 8, 1, 9, 4, 12, 5, 13);
    const Floats rs = __builtin_shufflevector(r, s, 0, 8, 1, 9, 4, 12, 5, 13);
    const Floats pq_high = __builtin_shufflevector(p, q, 2, 10, 3, 11, 6, 14, 7, 15);
    const Floats rs_high = __builtin_shufflevector(r, s, 2, 10, 3, 11, 6, 14, 7, 15);
    out.x = __builtin_shufflevector(pq, rs, 0, 1, 8, 9, 4, 5, 12, 13);
    out.y = __builtin_shufflevector(pq, rs, 2, 3, 10, 11, 6, 7, 14, 15);
    out.z = __builtin_shufflevector(pq_high, rs_high, 0, 1, 8, 9, 4, 5, 12, 13);
}

// Pixel range from the first one at or after the smallest of three numbers to the last one at or
// before the largest.
struct Range {
    Ints begin;
    Ints end;  // inclusive
};
ATRIUM_INLINE void pixels_between(
    const Floats& a, const Floats& b, const Floats& c, int size, Range& out) {
    const Floats last = Floats{} + static_cast<float>(size - 1);
    const Floats after = last + 1.0f;
    const Floats before = Floats{} - 1.0f;
    Floats low = a < b ? a : b;
    low = low < c ? low : c;
    low = low < after ? low : after;
    low = low > 0.0f ? low : Floats{};
    Floats high = a > b ? a : b;
    high = high > c ? high : c;
    high = high > before ? high : before;
    high = high < last ? high : last;
    const Ints low_whole = __builtin_convertvector(low, Ints);
    const Ints high_whole = __builtin_convertvector(high, Ints);
    // a true comparison is -1
    out.begin = low_whole - (low > __builtin_convertvector(low_whole, Floats));
    out.end = high_whole + (high < __builtin_convertvector(high_whole, Floats));
}

// Edge and depth functions of eight triangles: barycentric coordinates and inverse depth, affine in
// the pixel.
struct Affine {
    Floats x, y;   // gradients per column and per row
    Floats first;  // values at the first column and row
};
struct Prepared {
    Ints is_drawn;
    Range columns, rows;
    Affine a, b, c, value;
};

ATRIUM_INLINE void prepare(const Corners& a,
                           const Corners& b,
                           const Corners& c,
                           const InverseDepthPicture& picture,
                           Prepared& out) {
    const Floats ab_x = b.x - a.x, ab_y = b.y - a.y;
    const Floats ac_x = c.x - a.x, ac_y = c.y - a.y;
    // y points down, so a triangle that is counter-clockwise from outside has negative area here
    const Floats area = ab_x * ac_y - ab_y * ac_x;
    pixels_between(a.x, b.x, c.x, picture.width, out.columns);
    pixels_between(a.y, b.y, c.y, picture.height, out.rows);
    // most triangles are small, and many lie between pixel centres
    out.is_drawn = (area < 0.0f) & (a.z > 0.0f) & (b.z > 0.0f) & (c.z > 0.0f) &
                   (out.columns.begin <= out.columns.end) & (out.rows.begin <= out.rows.end);
    const Floats inverse_area = 1.0f / area;
    out.b.x = ac_y * inverse_area;
    out.b.y = -ac_x * inverse_area;
    out.c.x = -ab_y * inverse_area;
    out.c.y = ab_x * inverse_area;
    out.a.x = -out.b.x - out.c.x;
    out.a.y = -out.b.y - out.c.y;
    const Floats dx = __builtin_convertvector(out.columns.begin, Floats) - a.x;
    const Floats dy = __builtin_convertvector(out.rows.begin, Floats) - a.y;
    out.b.first = dx * out.b.x + dy * out.b.y;
    out.c.first = dx * out.c.x + dy * out.c.y;
    out.a.first = 1.0f - out.b.first - out.c.first;
    const Floats slope_b = b.z - a.z;
    const Floats slope_c = c.z - a.z;
    out.value.x = out.b.x * slope_b + out.c.x * slope_c;
    out.value.y = out.b.y * slope_b + out.c.y * slope_c;
    out.value.first = a.z + out.b.first * slope_b + out.c.first * slope_c;
}

// Broadcasts a lane from memory to all lanes.
ATRIUM_INLINE void spread(const Floats& from, int lane, Floats& out) {
    float value = 0.0f;
    std::memcpy(&value, reinterpret_cast<const char*>(&from) + 4 * lane, sizeof value);
    out = value - Floats{};  // exactly `value`
}

// Evaluates the function of triangle `i` at some columns of the first row.
ATRIUM_INLINE void begin(const Affine& eight, int i, const Floats& columns, Floats& out) {
    Floats x, first;
    spread(eight.x, i, x);
    spread(eight.first, i, first);
    out = columns * x + first;
}

// Draws triangle `i` of eight. Returns the number of pixels visited.
ATRIUM_INLINE std::int64_t draw_triangle(const Prepared& eight,
                                         int i,
                                         InverseDepthPicture& picture) {
    const int num_columns = eight.columns.end[i] - eight.columns.begin[i] + 1;
    const int num_rows = eight.rows.end[i] - eight.rows.begin[i] + 1;
    const std::ptrdiff_t stride = picture.width;
    float* corner = picture.values.data() + eight.rows.begin[i] * stride + eight.columns.begin[i];
    Floats a_y, b_y, c_y, value_y;
    spread(eight.a.y, i, a_y);
    spread(eight.b.y, i, b_y);
    spread(eight.c.y, i, c_y);
    spread(eight.value.y, i, value_y);
    for (int x = 0; x < num_columns; x += kLanes) {
        const Ints columns = kSteps + x;
        const Floats at_columns = __builtin_convertvector(columns, Floats);
        const Ints is_column = columns < num_columns;
        Floats a, b, c, value;
        begin(eight.a, i, at_columns, a);
        begin(eight.b, i, at_columns, b);
        begin(eight.c, i, at_columns, c);
        begin(eight.value, i, at_columns, value);
        float* at = corner + x;
        for (int y = 0; y < num_rows; ++y, at += stride) {
            Floats inside = b < c ? b : c;
            inside = inside < a ? inside : a;
            const Ints is_inside = (inside >= 0.0f) & is_column;
            const Floats drawn =
                reinterpret_cast<Floats>(reinterpret_cast<Ints>(value) & is_inside);
            // lanes beyond the triangle keep their value, even in the next row
            Floats found;
            std::memcpy(&found, at, sizeof found);
            found = found < drawn ? drawn : found;
            std::memcpy(at, &found, sizeof found);
            a += a_y;
            b += b_y;
            c += c_y;
            value += value_y;
        }
    }
    return std::int64_t{num_columns} * num_rows;
}

ATRIUM_INLINE void draw(std::span<const Eigen::Vector4f> corners,
                        std::span<const std::array<std::uint32_t, 3>> triangles,
                        InverseDepthPicture& picture) {
    // a person covers the picture three or four times; this stops nonsense meshes
    constexpr std::int64_t kMostTimes = 50;
    std::int64_t left = kMostTimes * picture.width * picture.height;
    std::array<std::array<std::uint32_t, 3>, kLanes> last{};
    for (std::size_t t = 0; t < triangles.size() && left > 0; t += kLanes) {
        const std::array<std::uint32_t, 3>* from = triangles.data() + t;
        if (t + kLanes > triangles.size()) {
            // padding lanes, and triangles without area
            std::copy(
                triangles.begin() + static_cast<std::ptrdiff_t>(t), triangles.end(), last.begin());
            from = last.data();
        }
        Corners a, b, c;
        gather(corners, from, 0, a);
        gather(corners, from, 1, b);
        gather(corners, from, 2, c);
        Prepared eight;
        prepare(a, b, c, picture, eight);
        for (int i = 0; i < kLanes; ++i)
            if (eight.is_drawn[i] != 0) left -= draw_triangle(eight, i, picture);
    }
}

constexpr float kNowhere = 1e9f;

struct Bounds {
    std::array<float, 2> low{kNowhere, kNowhere};
    std::array<float, 2> high{-kNowhere, -kNowhere};
};

// Range of the points before the camera along one axis.
ATRIUM_INLINE void find_bounds(const std::vector<float>& values,
                               const std::vector<float>& inverse_depths,
                               float& least,
                               float& most) {
    Floats low = Floats{} + kNowhere;
    Floats high = Floats{} - kNowhere;
    std::size_t i = 0;
    for (; i + kLanes <= values.size(); i += kLanes) {
        Floats value, inverse_depth;
        std::memcpy(&value, values.data() + i, sizeof value);
        std::memcpy(&inverse_depth, inverse_depths.data() + i, sizeof inverse_depth);
        const Ints is_before = inverse_depth > 0.0f;
        low = is_before & (value < low) ? value : low;
        high = is_before & (value > high) ? value : high;
    }
    for (int lane = 0; lane < kLanes; ++lane) {
        least = std::min(least, low[lane]);
        most = std::max(most, high[lane]);
    }
    for (; i < values.size(); ++i) {
        if (!(inverse_depths[i] > 0.0f)) continue;
        least = std::min(least, values[i]);
        most = std::max(most, values[i]);
    }
}

ATRIUM_INLINE void find_bounds(const Axes& points, Bounds& out) {
    find_bounds(points.x, points.z, out.low[0], out.high[0]);
    find_bounds(points.y, points.z, out.low[1], out.high[1]);
}

ATRIUM_INLINE void store_two(const Floats& from, Eigen::Vector4f& low, Eigen::Vector4f& high) {
    std::memcpy(low.data(), &from, sizeof(Four));
    const Four upper = __builtin_shufflevector(from, from, 4, 5, 6, 7);
    std::memcpy(high.data(), &upper, sizeof upper);
}

// Maps (x, y) to ((x, y) - origin) * scale.
ATRIUM_INLINE void place(const Axes& points,
                         const std::array<float, 2>& origin,
                         float scale,
                         std::vector<Eigen::Vector4f>& out) {
    std::size_t i = 0;
    for (; i + kLanes <= points.size(); i += kLanes) {
        Floats x, y, z;
        std::memcpy(&x, points.x.data() + i, sizeof x);
        std::memcpy(&y, points.y.data() + i, sizeof y);
        std::memcpy(&z, points.z.data() + i, sizeof z);
        x = (x - origin[0]) * scale;
        y = (y - origin[1]) * scale;
        const Floats xy = __builtin_shufflevector(x, y, 0, 8, 1, 9, 4, 12, 5, 13);
        const Floats xy_high = __builtin_shufflevector(x, y, 2, 10, 3, 11, 6, 14, 7, 15);
        const Floats zw = __builtin_shufflevector(z, Floats{}, 0, 8, 1, 9, 4, 12, 5, 13);
        const Floats zw_high = __builtin_shufflevector(z, Floats{}, 2, 10, 3, 11, 6, 14, 7, 15);
        Eigen::Vector4f* to = out.data() + i;
        store_two(__builtin_shufflevector(xy, zw, 0, 1, 8, 9, 4, 5, 12, 13), to[0], to[4]);
        store_two(__builtin_shufflevector(xy, zw, 2, 3, 10, 11, 6, 7, 14, 15), to[1], to[5]);
        store_two(
            __builtin_shufflevector(xy_high, zw_high, 0, 1, 8, 9, 4, 5, 12, 13), to[2], to[6]);
        store_two(
            __builtin_shufflevector(xy_high, zw_high, 2, 3, 10, 11, 6, 7, 14, 15), to[3], to[7]);
    }
    for (; i < points.size(); ++i) {
        out[i] = {(points.x[i] - origin[0]) * scale,
                  (points.y[i] - origin[1]) * scale,
                  points.z[i],
                  0.0f};
    }
}

#ifdef ATRIUM_AVX2
ATRIUM_AVX2 void find_bounds_avx2(const Axes& points, Bounds& out) { find_bounds(points, out); }
ATRIUM_AVX2 void place_avx2(const Axes& points,
                            const std::array<float, 2>& origin,
                            float scale,
                            std::vector<Eigen::Vector4f>& out) {
    place(points, origin, scale, out);
}
ATRIUM_AVX2 void draw_avx2(std::span<const Eigen::Vector4f> corners,
                           std::span<const std::array<std::uint32_t, 3>> triangles,
                           InverseDepthPicture& picture) {
    draw(corners, triangles, picture);
}
#endif

}  // namespace

void fit_inverse_depth(const Axes& points,
                       int long_side_px,
                       std::vector<Eigen::Vector4f>& corners,
                       InverseDepthPicture& picture,
                       [[maybe_unused]] RowCode code) {
    constexpr int kBorder = 1;
    Bounds bounds;
#ifdef ATRIUM_AVX2
    if (code == RowCode::kAvx2)
        find_bounds_avx2(points, bounds);
    else
#endif
        find_bounds(points, bounds);
    corners.resize(points.size());
    if (bounds.low[0] > bounds.high[0]) {  // nothing before the camera
        picture.width = picture.height = 1;
        picture.scale = 1.0f;
        picture.origin_px.setZero();
        std::fill(corners.begin(), corners.end(), Eigen::Vector4f::Zero());
        return;
    }
    const float width = bounds.high[0] - bounds.low[0];
    const float height = bounds.high[1] - bounds.low[1];
    const float scale =
        static_cast<float>(long_side_px - 1) / std::max(std::max(width, height), 1.0f);
    picture.scale = scale;
    picture.width = static_cast<int>(width * scale) + 2 + 2 * kBorder;
    picture.height = static_cast<int>(height * scale) + 2 + 2 * kBorder;
    const std::array<float, 2> origin{bounds.low[0] - kBorder / scale,
                                      bounds.low[1] - kBorder / scale};
    picture.origin_px = {origin[0], origin[1]};
#ifdef ATRIUM_AVX2
    if (code == RowCode::kAvx2)
        place_avx2(points, origin, scale, corners);
    else
#endif
        place(points, origin, scale, corners);
}

void draw_inverse_depth(std::span<const Eigen::Vector4f> corners,
                        std::span<const std::array<std::uint32_t, 3>> triangles,
                        InverseDepthPicture& picture,
                        [[maybe_unused]] RowCode code) {
    picture.values.assign(
        static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) + kLanes,
        0.0f);
#ifdef ATRIUM_AVX2
    if (code == RowCode::kAvx2) return draw_avx2(corners, triangles, picture);
#endif
    draw(corners, triangles, picture);
}

}  // namespace atrium::image
