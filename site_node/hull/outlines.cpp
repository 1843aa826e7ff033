#include "site_node/hull/outlines.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>

namespace atrium::hull {
namespace {

using Point = Eigen::Vector2d;

// Points closer than this are one: far below any picture's resolution, far above the jitter.
constexpr double kSamePoint_px = 1e-4;

// Per view and frame. A real contour crosses itself a few times at most; what does it more often is
// a scribble.
constexpr int kMaxRepairs = 300;

bool less_yx(const Point& a, const Point& b) {
    return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
}

double cross(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }

// > 0: c lies left of a -> b in x-right, y-up axes
double side(const Point& a, const Point& b, const Point& c) { return cross(b - a, c - a); }

bool segments_cross(const Point& a, const Point& b, const Point& c, const Point& d) {
    return (side(a, b, c) > 0.0) != (side(a, b, d) > 0.0) &&
           (side(c, d, a) > 0.0) != (side(c, d, b) > 0.0);
}

Point crossing_point(const Point& a, const Point& b, const Point& c, const Point& d) {
    const double at_a = side(c, d, a);
    const double at_b = side(c, d, b);
    return a + (b - a) * (at_a / (at_a - at_b));
}

// A spike goes out and comes back the same way: the middle point bounds nothing.
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

double swept_area_px2(std::span<const Point> loop) {
    double twice = 0.0;
    for (std::size_t i = 2; i < loop.size(); ++i)
        twice += std::abs(side(loop[0], loop[i - 1], loop[i]));
    return 0.5 * twice;
}

void drop_small(Outlines& outlines,
                double min_area_px2,
                OutlineScratch& scratch,
                OutlineCounts& counts) {
    scratch.other.clear();
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        if (std::abs(signed_area_px2(outlines.contour(c))) >= min_area_px2) {
            scratch.other.append(outlines.contour(c));
        } else {
            ++counts.dropped;
        }
    }
    std::swap(outlines, scratch.other);
}

std::uint64_t mix(std::uint64_t x) {  // splitmix64's finaliser
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ULL;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

struct Crossing {
    std::uint32_t p = 0;  // segment p -> next(p)
    std::uint32_t q = 0;
};

// Finds one crossing; segments are taken by rising y so that only those that overlap in y meet.
class CrossingFinder {
public:
    CrossingFinder(const Outlines& outlines, OutlineScratch& scratch)
        : outlines_(outlines), scratch_(scratch) {
        const auto n = static_cast<std::uint32_t>(outlines.points.size());
        scratch.contour_of.resize(n);
        for (std::uint32_t c = 0; c < outlines.num_contours(); ++c) {
            for (std::uint32_t i = outlines.begin_of(c); i < outlines.ends[c]; ++i)
                scratch.contour_of[i] = c;
        }
        scratch.order.resize(n);
        std::iota(scratch.order.begin(), scratch.order.end(), 0u);
        std::sort(
            scratch.order.begin(), scratch.order.end(), [&](std::uint32_t l, std::uint32_t r) {
                const double yl = low(l);
                const double yr = low(r);
                return yl != yr ? yl < yr : l < r;
            });
    }

    std::uint32_t next(std::uint32_t i) const {
        const std::uint32_t c = scratch_.contour_of[i];
        return i + 1 < outlines_.ends[c] ? i + 1 : outlines_.begin_of(c);
    }

    std::optional<Crossing> find(std::uint64_t max_tests, std::uint64_t& num_tests) const {
        const auto& order = scratch_.order;
        const auto& points = outlines_.points;
        for (std::size_t a = 0; a < order.size(); ++a) {
            const std::uint32_t p = order[a];
            const Point& p0 = points[p];
            const Point& p1 = points[next(p)];
            const double high = std::max(p0.y(), p1.y());
            const double left = std::min(p0.x(), p1.x());
            const double right = std::max(p0.x(), p1.x());
            for (std::size_t b = a + 1; b < order.size() && low(order[b]) <= high; ++b) {
                const std::uint32_t q = order[b];
                if (++num_tests > max_tests) return std::nullopt;
                const Point& q0 = points[q];
                const Point& q1 = points[next(q)];
                if (std::max(q0.x(), q1.x()) < left || std::min(q0.x(), q1.x()) > right) continue;
                if (next(p) == q || next(q) == p) continue;
                if (segments_cross(p0, p1, q0, q1)) return Crossing{std::min(p, q), std::max(p, q)};
            }
        }
        return std::nullopt;
    }

private:
    double low(std::uint32_t i) const {
        return std::min(outlines_.points[i].y(), outlines_.points[next(i)].y());
    }

    const Outlines& outlines_;
    OutlineScratch& scratch_;
};

// Appends the loop `x, points[first .. last]` (cyclic inside its contour), x moved a little into
// its corner so that the two halves of a split do not touch.
void append_half(const Outlines& from,
                 std::uint32_t contour,
                 std::uint32_t first,
                 std::uint32_t last,
                 const Point& x,
                 double min_area_px2,
                 OutlineScratch& scratch,
                 OutlineCounts& counts) {
    std::vector<Point>& loop = scratch.loop;
    loop.clear();
    loop.push_back(x);
    for (std::uint32_t i = first;;
         i = i + 1 < from.ends[contour] ? i + 1 : from.begin_of(contour)) {
        loop.push_back(from.points[i]);
        if (i == last) break;
    }
    const Point bisector = (loop[1] - x).stableNormalized() + (loop.back() - x).stableNormalized();
    loop[0] += 10.0 * kSamePoint_px * bisector.stableNormalized();
    if (loop.size() < 3 || std::abs(signed_area_px2(loop)) < min_area_px2) {
        ++counts.dropped;
        return;
    }
    scratch.other.append(loop);
}

}  // namespace

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
        copy_clean(contour, scratch.loop);
        std::vector<Point>& loop = scratch.loop;
        // not the area: a loop that crosses itself may have none before it is split
        if (loop.size() < 3 || !(swept_area_px2(loop) >= min_area_px2)) {
            ++counts.dropped;
            continue;
        }
        if (signed_area_px2(loop) < 0.0) std::reverse(loop.begin(), loop.end());
        std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end(), less_yx), loop.end());
        loops.append(loop);
    }
    scratch.order.resize(loops.num_contours());
    std::iota(scratch.order.begin(), scratch.order.end(), 0u);
    std::sort(scratch.order.begin(), scratch.order.end(), [&](std::uint32_t l, std::uint32_t r) {
        const auto cl = loops.contour(l);
        const auto cr = loops.contour(r);
        return std::lexicographical_compare(cl.begin(), cl.end(), cr.begin(), cr.end(), less_yx);
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

bool make_simple(Outlines& outlines,
                 double min_area_px2,
                 std::uint64_t max_tests,
                 OutlineScratch& scratch,
                 OutlineCounts& counts) {
    std::uint64_t num_tests = 0;
    for (int repairs = 0; repairs < kMaxRepairs; ++repairs) {
        const CrossingFinder finder(outlines, scratch);
        const std::optional<Crossing> found = finder.find(max_tests, num_tests);
        if (num_tests > max_tests) return false;
        if (!found) {
            drop_small(outlines, min_area_px2, scratch, counts);
            return true;
        }
        const std::uint32_t cp = scratch.contour_of[found->p];
        const std::uint32_t cq = scratch.contour_of[found->q];
        const auto area = [&](std::uint32_t c) {
            return std::abs(signed_area_px2(outlines.contour(c)));
        };
        const std::uint32_t smaller = area(cp) < area(cq) ? cp : cq;
        scratch.other.clear();
        for (std::uint32_t c = 0; c < outlines.num_contours(); ++c) {
            if (c != (cp == cq ? cp : smaller)) {
                scratch.other.append(outlines.contour(c));
            } else if (cp != cq) {
                ++counts.dropped;
            } else {
                const std::uint32_t after_p = finder.next(found->p);
                const std::uint32_t after_q = finder.next(found->q);
                const Point x = crossing_point(outlines.points[found->p],
                                               outlines.points[after_p],
                                               outlines.points[found->q],
                                               outlines.points[after_q]);
                append_half(outlines, c, after_p, found->q, x, min_area_px2, scratch, counts);
                append_half(outlines, c, after_q, found->p, x, min_area_px2, scratch, counts);
                ++counts.repaired;
            }
        }
        std::swap(outlines, scratch.other);
    }
    return false;
}

void orient_by_nesting(Outlines& outlines) {
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        const std::span<const Point> loop = outlines.contour(c);
        bool is_hole = false;
        for (std::size_t other = 0; other < outlines.num_contours(); ++other) {
            if (other == c) continue;
            const std::span<const Point> fence = outlines.contour(other);
            const Point& p = loop.front();
            for (std::size_t i = 0, j = fence.size() - 1; i < fence.size(); j = i++) {
                if ((fence[i].y() > p.y()) == (fence[j].y() > p.y())) continue;
                const bool rising = fence[i].y() > fence[j].y();
                if ((side(fence[j], fence[i], p) > 0.0) == rising) is_hole = !is_hole;
            }
        }
        if ((signed_area_px2(loop) < 0.0) != is_hole) {
            std::reverse(outlines.points.begin() + outlines.begin_of(c),
                         outlines.points.begin() + outlines.ends[c]);
        }
    }
}

bool contains(const Outlines& outlines, const Point& p) {
    bool inside = false;
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        const std::span<const Point> fence = outlines.contour(c);
        for (std::size_t i = 0, j = fence.size() - 1; i < fence.size(); j = i++) {
            if ((fence[i].y() > p.y()) == (fence[j].y() > p.y())) continue;
            const bool rising = fence[i].y() > fence[j].y();
            if ((side(fence[j], fence[i], p) > 0.0) == rising) inside = !inside;
        }
    }
    return inside;
}

}  // namespace atrium::hull
