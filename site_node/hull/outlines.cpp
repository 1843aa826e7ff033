#include "site_node/hull/outlines.hpp"

#include "site_node/hull/outlines_predicates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace atrium::hull {
namespace {

using Point = Eigen::Vector2d;

// Whether `tip` is a spike, where the outline returns along the same way. The tip encloses no area.
bool is_spike(const Point& before, const Point& tip, const Point& after) {
    const Point in = tip - before;
    const Point out = after - tip;
    const double scale = in.norm() * out.norm();
    return in.dot(out) < 0.0 &&
           std::abs(cross(in, out)) < kSamePoint_px * scale / std::max(in.norm(), out.norm());
}

void copy_clean(const std::vector<Point>& contour, std::vector<Point>& loop) {
    loop.clear();
    for (const Point& p : contour) {
        if (!loop.empty() && (p - loop.back()).squaredNorm() < kSamePoint_px * kSamePoint_px)
            continue;
        while (loop.size() >= 2 && is_spike(loop[loop.size() - 2], loop.back(), p)) loop.pop_back();
        if (!loop.empty() && (p - loop.back()).squaredNorm() < kSamePoint_px * kSamePoint_px)
            continue;
        loop.push_back(p);
    }
    while (loop.size() > 1 &&
           (loop.front() - loop.back()).squaredNorm() < kSamePoint_px * kSamePoint_px)
        loop.pop_back();
    while (loop.size() >= 3 && is_spike(loop[loop.size() - 2], loop.back(), loop.front()))
        loop.pop_back();
    std::size_t first = 0;
    while (loop.size() - first >= 3 && is_spike(loop.back(), loop[first], loop[first + 1])) ++first;
    loop.erase(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(first));
}

// Returns the start of the rotation of `loop` that is least in lexicographical order of its points
// (less_yx). Unless the least point is unique, this uses the two-pointer algorithm for the minimal
// rotation, in O(n).
std::size_t least_rotation(std::span<const Point> loop) {
    const std::size_t n = loop.size();
    std::size_t least = 0;
    bool is_only_one = true;
    for (std::size_t p = 1; p < n; ++p) {
        if (less_yx(loop[least], loop[p])) continue;
        is_only_one = less_yx(loop[p], loop[least]);
        least = p;
    }
    if (is_only_one) return least;  // the usual case
    std::size_t i = 0;
    std::size_t j = 1;
    std::size_t same = 0;  // length of the common run that starts at i and at j
    while (i < n && j < n && same < n) {
        const Point& a = loop[(i + same) % n];
        const Point& b = loop[(j + same) % n];
        if (a == b) {
            ++same;
            continue;
        }
        (less_yx(b, a) ? i : j) += same + 1;
        if (i == j) ++j;
        same = 0;
    }
    return std::min(i, j);
}

void rotate_to_least(std::vector<Point>& loop) {
    const auto first = static_cast<std::ptrdiff_t>(least_rotation(loop));
    std::rotate(loop.begin(), loop.begin() + first, loop.end());
}

bool is_before(std::span<const Point> a, std::span<const Point> b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), less_yx);
}

// Replaces `loop` by the least of its 2n equivalent forms (n rotations, two directions).
void make_canonical(std::vector<Point>& loop, std::vector<Point>& reversed) {
    reversed.assign(loop.rbegin(), loop.rend());
    rotate_to_least(loop);
    rotate_to_least(reversed);
    if (is_before(reversed, loop)) std::swap(loop, reversed);
}

std::uint64_t mix(std::uint64_t x) {  // the finaliser of splitmix64
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ULL;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

}  // namespace

double swept_area_px2(std::span<const Point> loop) {
    double twice = 0.0;
    for (std::size_t i = 2; i < loop.size(); ++i)
        twice += std::abs(side(loop[0], loop[i - 1], loop[i]));
    return 0.5 * twice;
}

double signed_area_px2(std::span<const Point> loop) {
    double twice = 0.0;
    for (std::size_t i = 2; i < loop.size(); ++i) twice += side(loop[0], loop[i - 1], loop[i]);
    return 0.5 * twice;
}

void copy_canonical(const std::vector<std::vector<Point>>& contours,
                    double min_area_px2,
                    OutlineScratch& scratch,
                    Outlines& out,
                    OutlineCounts& counts) {
    Outlines& loops = scratch.other;
    loops.clear();
    for (const std::vector<Point>& contour : contours) {
        // the result of cleaning depends on its start, so the start has to be canonical too
        std::vector<Point>& raw = scratch.raw;
        raw.clear();
        for (const Point& p : contour) raw.emplace_back(p.x() + 0.0, p.y() + 0.0);  // no -0
        make_canonical(raw, scratch.loop);
        std::vector<Point>& loop = scratch.loop;
        copy_clean(raw, loop);
        // not the signed area: a loop that crosses itself may have none before it is split
        if (loop.size() < 3 || !(swept_area_px2(loop) >= min_area_px2)) {
            ++counts.dropped;
            continue;
        }
        make_canonical(loop, raw);
        if (signed_area_px2(loop) < 0.0) {
            std::reverse(loop.begin(), loop.end());
            rotate_to_least(loop);
        }
        loops.append(loop);
    }
    scratch.order.resize(loops.num_contours());
    std::iota(scratch.order.begin(), scratch.order.end(), 0u);
    std::sort(scratch.order.begin(), scratch.order.end(), [&](std::uint32_t l, std::uint32_t r) {
        return is_before(loops.contour(l), loops.contour(r));
    });
    out.clear();
    for (const std::uint32_t c : scratch.order) out.append(loops.contour(c));
}

void jitter(Outlines& outlines, double amplitude_px, std::uint64_t seed) {
    std::uint64_t index = 0;
    for (Point& p : outlines.points) {
        std::uint64_t h = mix(seed + 0x9e3779b97f4a7c15ULL * ++index);
        h = mix(h ^ std::bit_cast<std::uint64_t>(p.x()));
        h = mix(h ^ std::bit_cast<std::uint64_t>(p.y()));
        constexpr double kToUnit = 1.0 / 2147483648.0;  // 32 bits to [0, 2)
        p.x() += amplitude_px * (static_cast<double>(h >> 32) * kToUnit - 1.0);
        p.y() += amplitude_px * (static_cast<double>(h & 0xffffffffu) * kToUnit - 1.0);
    }
}

void orient_by_nesting(Outlines& outlines) {
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        const std::span<const Point> loop = outlines.contour(c);
        bool is_hole = false;
        for (std::size_t other = 0; other < outlines.num_contours(); ++other) {
            if (other != c && contains(outlines.contour(other), loop.front())) is_hole = !is_hole;
        }
        if ((signed_area_px2(loop) < 0.0) != is_hole) {
            std::reverse(outlines.points.begin() + outlines.begin_of(c),
                         outlines.points.begin() + outlines.ends[c]);
        }
    }
}

bool contains(std::span<const Point> loop, const Point& p) {
    bool inside = false;
    for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
        if ((loop[i].y() > p.y()) == (loop[j].y() > p.y())) continue;
        const bool rising = loop[i].y() > loop[j].y();
        if ((side(loop[j], loop[i], p) > 0.0) == rising) inside = !inside;
    }
    return inside;
}

bool contains(const Outlines& outlines, const Point& p) {
    bool inside = false;
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        if (contains(outlines.contour(c), p)) inside = !inside;
    }
    return inside;
}

std::uint32_t drop_outside(Outlines& outlines, const Eigen::AlignedBox2d& box) {
    std::uint32_t num_points = 0;
    std::size_t num_kept = 0;
    std::uint32_t begin = 0;
    const std::size_t n = outlines.num_contours();
    for (std::size_t c = 0; c < n; ++c) {
        const std::uint32_t end = outlines.ends[c];
        Eigen::AlignedBox2d extent;
        for (std::uint32_t i = begin; i < end; ++i) extent.extend(outlines.points[i]);
        if (extent.intersects(box)) {
            std::copy(outlines.points.begin() + begin,
                      outlines.points.begin() + end,
                      outlines.points.begin() + num_points);
            num_points += end - begin;
            outlines.ends[num_kept++] = num_points;
        }
        begin = end;
    }
    outlines.points.resize(num_points);
    outlines.ends.resize(num_kept);
    return static_cast<std::uint32_t>(n - num_kept);
}

}  // namespace atrium::hull
