#include "site_node/hull/outlines.hpp"
#include "site_node/hull/outlines_predicates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

// One sweep finds all crossings, and they are resolved together: where two edges cross, each strand
// continues along the other one. Strands keep their directions and touch afterwards where they
// crossed, so the order of repairs does not matter and the even-odd interior stays the same. Then
// the two copies of a crossing move apart. This can make a copy cross a strand that passes very
// close, so the sweep repeats with ever smaller distances.
namespace atrium::hull {
namespace {

using Point = Eigen::Vector2d;
using Edge = OutlineScratch::Edge;
using Crossing = OutlineScratch::Crossing;
using Cut = OutlineScratch::Cut;

// Per view and frame. A real contour crosses itself a few times at most; only scribbles need more.
constexpr std::size_t kMaxRepairs = 1000;

constexpr int kMaxRounds = 12;
constexpr double kDrawBack_px = 10.0 * kSamePoint_px;  // in the first round
constexpr double kSmallestFactor = 1e-6;               // doubles still resolve 1e-9 px

void list_edges(const Outlines& outlines, OutlineScratch& scratch) {
    scratch.edges.clear();
    for (std::uint32_t c = 0; c < outlines.num_contours(); ++c) {
        const std::uint32_t begin = outlines.begin_of(c);
        const std::uint32_t end = outlines.ends[c];
        for (std::uint32_t i = begin; i < end; ++i) {
            const std::uint32_t to = i + 1 < end ? i + 1 : begin;
            const Point& a = outlines.points[i];
            const Point& b = outlines.points[to];
            scratch.edges.push_back({std::min(a.y(), b.y()),
                                     std::max(a.y(), b.y()),
                                     std::min(a.x(), b.x()),
                                     std::max(a.x(), b.x()),
                                     i,
                                     to,
                                     c});
        }
    }
    std::sort(scratch.edges.begin(), scratch.edges.end(), [](const Edge& l, const Edge& r) {
        return l.low != r.low ? l.low < r.low : l.from < r.from;
    });
}

// Calls `on_crossing(edge, edge)` for every crossing until it returns false. Takes edges by rising
// y, so only edges that overlap in y are paired. Skips dropped contours. Returns false if it needs
// more than `max_tests` pairs.
template <typename OnCrossing>
bool sweep(const Outlines& outlines,
           OutlineScratch& scratch,
           std::uint64_t max_tests,
           std::uint64_t& num_tests,
           OnCrossing on_crossing) {
    list_edges(outlines, scratch);
    scratch.is_dropped.assign(outlines.num_contours(), 0);
    const std::vector<Edge>& edges = scratch.edges;
    for (std::size_t a = 0; a < edges.size(); ++a) {
        const Edge& p = edges[a];
        for (std::size_t b = a + 1; b < edges.size() && edges[b].low <= p.high; ++b) {
            const Edge& q = edges[b];
            if (scratch.is_dropped[p.contour]) break;
            if (++num_tests > max_tests) return false;
            if (q.right < p.left || q.left > p.right) continue;
            if (p.to == q.from || q.to == p.from || scratch.is_dropped[q.contour]) continue;
            if (!segments_cross(outlines.points[p.from],
                                outlines.points[p.to],
                                outlines.points[q.from],
                                outlines.points[q.to]))
                continue;
            if (!on_crossing(p, q)) return true;
        }
    }
    return true;
}

void add_crossing(const Outlines& outlines, const Edge& p, const Edge& q, OutlineScratch& scratch) {
    const Point& p0 = outlines.points[p.from];
    const Point& p1 = outlines.points[p.to];
    const Point& q0 = outlines.points[q.from];
    const Point& q1 = outlines.points[q.to];
    const double at_p = crossing_parameter(p0, p1, q0, q1);
    const double at_q = crossing_parameter(q0, q1, p0, p1);
    const auto index = static_cast<std::uint32_t>(scratch.crossings.size());
    const Point bisector = (q1 - q0).stableNormalized() - (p1 - p0).stableNormalized();
    scratch.crossings.push_back(
        {p.from, q.from, p0 + at_p * (p1 - p0), bisector.stableNormalized()});
    scratch.cuts.push_back({p.from, at_p, index, true});
    scratch.cuts.push_back({q.from, at_q, index, false});
}

// Links the nodes to loops. A node is a point or one of the two copies of a crossing: the first
// copy comes along p and leaves along q, the second one the other way round.
void link_nodes(const Outlines& outlines, OutlineScratch& scratch) {
    const auto n = static_cast<std::uint32_t>(outlines.points.size());
    const std::size_t num_nodes = n + 2 * scratch.crossings.size();
    scratch.next.resize(num_nodes);
    scratch.place.assign(outlines.points.begin(), outlines.points.end());
    for (const Crossing& x : scratch.crossings) scratch.place.insert(scratch.place.end(), 2, x.at);
    scratch.room.assign(num_nodes, std::numeric_limits<double>::max());
    for (const Edge& e : scratch.edges) scratch.next[e.from] = e.to;

    std::sort(scratch.cuts.begin(), scratch.cuts.end(), [](const Cut& l, const Cut& r) {
        if (l.edge != r.edge) return l.edge < r.edge;
        return l.parameter != r.parameter ? l.parameter < r.parameter : l.crossing < r.crossing;
    });
    const auto leave_for = [&](std::uint32_t from, std::uint32_t to) {
        const double length = (scratch.place[to] - scratch.place[from]).norm();
        scratch.room[from] = std::min(scratch.room[from], length);
        scratch.room[to] = std::min(scratch.room[to], length);
        scratch.next[from] = to;
    };
    for (std::size_t i = 0; i < scratch.cuts.size();) {
        const std::uint32_t edge = scratch.cuts[i].edge;
        const std::uint32_t end = scratch.next[edge];
        std::uint32_t node = edge;
        for (; i < scratch.cuts.size() && scratch.cuts[i].edge == edge; ++i) {
            const Cut& cut = scratch.cuts[i];
            const std::uint32_t first = n + 2 * cut.crossing;
            leave_for(node, cut.is_p ? first : first + 1);
            node = cut.is_p ? first + 1 : first;
        }
        leave_for(node, end);
    }
}

// Moves each copy into its own corner, but not so far that its edges fold.
void draw_copies_back(std::size_t num_points, double distance_px, OutlineScratch& scratch) {
    for (std::size_t k = 0; k < scratch.crossings.size(); ++k) {
        const std::size_t first = num_points + 2 * k;
        const Point& bisector = scratch.crossings[k].bisector;
        scratch.place[first] += std::min(distance_px, 0.25 * scratch.room[first]) * bisector;
        scratch.place[first + 1] -=
            std::min(distance_px, 0.25 * scratch.room[first + 1]) * bisector;
    }
}

// Writes the loop through node `start`, without copies of crossings closer than `same_px` to a
// neighbour.
void collect_loop(std::uint32_t start,
                  std::size_t num_points,
                  double same_px,
                  OutlineScratch& scratch) {
    std::vector<Point>& loop = scratch.loop;
    std::vector<std::uint8_t>& is_crossing = scratch.is_crossing;
    loop.clear();
    is_crossing.clear();
    std::uint32_t node = start;
    do {
        scratch.is_done[node] = 1;
        const bool crosses = node >= num_points;
        const Point& p = scratch.place[node];
        const bool is_same = !loop.empty() && (p - loop.back()).norm() < same_px;
        if (is_same && !crosses && is_crossing.back()) {
            loop.back() = p;
            is_crossing.back() = 0;
        } else if (!(is_same && crosses)) {
            loop.push_back(p);
            is_crossing.push_back(crosses);
        }
        node = scratch.next[node];
    } while (node != start);
    while (loop.size() > 1 && is_crossing.back() && (loop.back() - loop.front()).norm() < same_px) {
        loop.pop_back();
        is_crossing.pop_back();
    }
}

void splice(Outlines& outlines,
            double draw_back_px,
            double min_area_px2,
            OutlineScratch& scratch,
            OutlineCounts& counts) {
    const std::size_t n = outlines.points.size();
    link_nodes(outlines, scratch);
    draw_copies_back(n, draw_back_px, scratch);
    scratch.other.clear();
    scratch.is_done.assign(scratch.next.size(), 0);
    for (std::uint32_t node = 0; node < scratch.next.size(); ++node) {
        if (scratch.is_done[node]) continue;
        collect_loop(node, n, draw_back_px * (kSamePoint_px / kDrawBack_px), scratch);
        // not the signed area: it may still cross itself
        if (scratch.loop.size() < 3 || swept_area_px2(scratch.loop) < min_area_px2) {
            ++counts.dropped;
        } else {
            scratch.other.append(scratch.loop);
        }
    }
    std::swap(outlines, scratch.other);
}

template <typename Keep>
void keep_if(Outlines& outlines, Keep keep, OutlineScratch& scratch, OutlineCounts& counts) {
    scratch.other.clear();
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        if (keep(c)) {
            scratch.other.append(outlines.contour(c));
        } else {
            ++counts.dropped;
        }
    }
    std::swap(outlines, scratch.other);
}

void list_areas(const Outlines& outlines, OutlineScratch& scratch) {
    scratch.area.clear();
    for (std::size_t c = 0; c < outlines.num_contours(); ++c)
        scratch.area.push_back(std::abs(signed_area_px2(outlines.contour(c))));
}

bool drop_crossing(Outlines& outlines,
                   std::uint64_t max_tests,
                   std::uint64_t& num_tests,
                   OutlineScratch& scratch,
                   OutlineCounts& counts) {
    list_areas(outlines, scratch);
    const auto drop_smaller = [&](const Edge& p, const Edge& q) {
        const bool q_is_smaller = scratch.area[q.contour] < scratch.area[p.contour];
        scratch.is_dropped[q_is_smaller ? q.contour : p.contour] = 1;
        return true;
    };
    if (!sweep(outlines, scratch, max_tests, num_tests, drop_smaller)) return false;
    keep_if(
        outlines, [&](std::size_t c) { return !scratch.is_dropped[c]; }, scratch, counts);
    return true;
}

}  // namespace

bool make_simple(Outlines& outlines,
                 double min_area_px2,
                 std::uint64_t max_tests,
                 OutlineScratch& scratch,
                 OutlineCounts& counts) {
    std::uint64_t num_tests = 0;
    std::size_t num_repairs = 0;
    double factor = 1.0;
    for (int round = 0;; ++round) {
        scratch.crossings.clear();
        scratch.cuts.clear();
        const std::size_t num_left = round < kMaxRounds ? kMaxRepairs - num_repairs : 0;
        const auto add = [&](const Edge& p, const Edge& q) {
            add_crossing(outlines, p, q, scratch);
            return scratch.crossings.size() < num_left;
        };
        if (num_left == 0) {
            if (!drop_crossing(outlines, max_tests, num_tests, scratch, counts)) return false;
            break;
        }
        if (!sweep(outlines, scratch, max_tests, num_tests, add)) return false;
        if (scratch.crossings.empty()) break;
        num_repairs += scratch.crossings.size();
        counts.repaired += static_cast<std::uint32_t>(scratch.crossings.size());
        splice(outlines, factor * kDrawBack_px, min_area_px2, scratch, counts);
        factor = std::max(0.1 * factor, kSmallestFactor);
    }
    list_areas(outlines, scratch);
    keep_if(
        outlines, [&](std::size_t c) { return scratch.area[c] >= min_area_px2; }, scratch, counts);
    return true;
}

}  // namespace atrium::hull
