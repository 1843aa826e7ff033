#include "site_node/hull/field_of_view.hpp"

#include "site_node/hull/outlines_predicates.hpp"

#include <algorithm>
#include <cmath>

// Polygon clipping after Weiler and Atherton (1977). Pieces of the border between two crossings
// alternate between foreground and background. Loops alternate between arcs of contours and pieces
// of the border.
namespace atrium::hull {
namespace {

using Point = Eigen::Vector2d;
using Crossing = FieldScratch::Crossing;

constexpr double kMinFieldArea_px2 = 1.0;
constexpr double kTooShort_px = 1e-9;  // for a segment: far below the jitter
constexpr std::uint32_t kNone = LabelledOutlines::kNoLoop;

bool is_in_box(const Point& p, const Point& a, const Point& b) {
    return (a.cwiseMin(b).array() <= p.array()).all() && (p.array() <= a.cwiseMax(b).array()).all();
}

bool segments_touch(const Point& a, const Point& b, const Point& c, const Point& d) {
    const double at_a = side(c, d, a);
    const double at_b = side(c, d, b);
    const double at_c = side(a, b, c);
    const double at_d = side(a, b, d);
    if (((at_a > 0.0 && at_b < 0.0) || (at_a < 0.0 && at_b > 0.0)) &&
        ((at_c > 0.0 && at_d < 0.0) || (at_c < 0.0 && at_d > 0.0)))
        return true;
    return (at_a == 0.0 && is_in_box(a, c, d)) || (at_b == 0.0 && is_in_box(b, c, d)) ||
           (at_c == 0.0 && is_in_box(c, a, b)) || (at_d == 0.0 && is_in_box(d, a, b));
}

bool folds_back(const Point& before, const Point& tip, const Point& after) {
    return side(before, tip, after) == 0.0 && (tip - before).dot(after - tip) <= 0.0;
}

void take_field(std::span<const Point> field, std::vector<Point>& out) {
    out.assign(field.begin(), field.end());
    if (signed_area_px2(out) < 0.0) std::reverse(out.begin(), out.end());
    std::rotate(out.begin(), std::min_element(out.begin(), out.end(), less_yx), out.end());
}

void cross_border(const Outlines& outlines,
                  std::uint32_t from,
                  std::uint32_t to,
                  FieldScratch& scratch) {
    const Point& a = outlines.points[from];
    const Point& b = outlines.points[to];
    const Point low = a.cwiseMin(b);
    const Point high = a.cwiseMax(b);
    const std::vector<Point>& field = scratch.field;
    const auto first = static_cast<std::ptrdiff_t>(scratch.crossings.size());
    for (std::size_t j = 0; j < field.size(); ++j) {
        const Point& c = field[j];
        const Point& d = field[j + 1 < field.size() ? j + 1 : 0];
        if (std::max(c.x(), d.x()) < low.x() || std::min(c.x(), d.x()) > high.x() ||
            std::max(c.y(), d.y()) < low.y() || std::min(c.y(), d.y()) > high.y())
            continue;
        if (!segments_cross(a, b, c, d)) continue;
        Crossing x{};
        x.along_contour = crossing_parameter(a, b, c, d);
        x.along_border = crossing_parameter(c, d, a, b);
        x.at = a + x.along_contour * (b - a);
        x.contour_edge = from;
        x.field_edge = static_cast<std::uint32_t>(j);
        x.enters = side(c, d, b) > 0.0;
        scratch.crossings.push_back(x);
    }
    std::sort(scratch.crossings.begin() + first,
              scratch.crossings.end(),
              [](const Crossing& l, const Crossing& r) {
                  return l.along_contour != r.along_contour ? l.along_contour < r.along_contour
                                                            : l.field_edge < r.field_edge;
              });
}

// Pairs the ends of the arcs inside the field. False if a contour enters the field twice in
// succession.
bool pair_crossings(std::uint32_t begin, bool starts_inside, std::vector<Crossing>& crossings) {
    const auto end = static_cast<std::uint32_t>(crossings.size());
    bool inside = starts_inside;
    for (std::uint32_t i = begin; i < end; ++i) {
        if (crossings[i].enters == inside) return false;
        inside = !inside;
        if (!crossings[i].enters) continue;
        const std::uint32_t leave = i + 1 < end ? i + 1 : begin;
        crossings[i].partner = leave;
        crossings[leave].partner = i;
    }
    return inside == starts_inside;
}

bool find_crossings(const Outlines& outlines, FieldScratch& scratch) {
    scratch.crossings.clear();
    scratch.crossing_ends.clear();
    scratch.starts_inside.clear();
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        const auto first = static_cast<std::uint32_t>(scratch.crossings.size());
        const std::uint32_t begin = outlines.begin_of(c);
        const std::uint32_t end = outlines.ends[c];
        for (std::uint32_t i = begin; i < end; ++i)
            cross_border(outlines, i, i + 1 < end ? i + 1 : begin, scratch);
        const bool starts_inside = contains(scratch.field, outlines.points[begin]);
        if (!pair_crossings(first, starts_inside, scratch.crossings)) return false;
        scratch.crossing_ends.push_back(static_cast<std::uint32_t>(scratch.crossings.size()));
        scratch.starts_inside.push_back(starts_inside);
    }
    return true;
}

// Checks that entering and leaving crossings alternate along the border, that no two arcs cross,
// and that the foreground along the border agrees with the contours. Foreground lies left of the
// contours: along the border it ends where a contour enters and begins where one leaves.
bool is_consistent(const Outlines& outlines, FieldScratch& scratch) {
    const std::vector<Crossing>& crossings = scratch.crossings;
    for (const std::uint32_t x : scratch.around) {
        if (crossings[x].enters == crossings[crossings[x].after].enters) return false;
    }
    scratch.open.clear();
    for (const std::uint32_t x : scratch.around) {
        if (!scratch.open.empty() && scratch.open.back() == crossings[x].partner) {
            scratch.open.pop_back();
        } else {
            scratch.open.push_back(x);
        }
    }
    return scratch.open.empty() &&
           (scratch.around.empty() ||
            contains(outlines, scratch.field.front()) == crossings[scratch.around.front()].enters);
}

void order_along_border(FieldScratch& scratch) {
    std::vector<Crossing>& crossings = scratch.crossings;
    std::vector<std::uint32_t>& around = scratch.around;
    around.resize(crossings.size());
    for (std::uint32_t x = 0; x < around.size(); ++x) around[x] = x;
    std::sort(around.begin(), around.end(), [&](std::uint32_t l, std::uint32_t r) {
        const Crossing& cl = crossings[l];
        const Crossing& cr = crossings[r];
        if (cl.field_edge != cr.field_edge) return cl.field_edge < cr.field_edge;
        return cl.along_border != cr.along_border ? cl.along_border < cr.along_border : l < r;
    });
    for (std::size_t i = 0; i < around.size(); ++i) {
        const std::uint32_t next = around[i + 1 < around.size() ? i + 1 : 0];
        crossings[around[i]].after = next;
        crossings[next].before = around[i];
    }
}

// Numbers the loops of the arc that begins at `enter`. From the end of an arc, the boundary of a
// foreground cell follows the border to the next crossing, that of a background cell to the
// previous one.
void number_loops(std::uint32_t enter, std::vector<Crossing>& crossings, LabelledOutlines& out) {
    if (crossings[enter].foreground_loop == kNone) {
        for (std::uint32_t x = enter; crossings[x].foreground_loop == kNone;
             x = crossings[crossings[x].partner].after)
            crossings[x].foreground_loop = out.num_foreground_loops;
        ++out.num_foreground_loops;
    }
    if (crossings[enter].background_loop == kNone) {
        for (std::uint32_t x = enter; crossings[x].background_loop == kNone;
             x = crossings[crossings[x].partner].before)
            crossings[x].background_loop = out.num_background_loops;
        ++out.num_background_loops;
    }
}

std::uint32_t add_point(const Point& p, LabelledOutlines& out) {
    out.points.push_back(p);
    return static_cast<std::uint32_t>(out.points.size() - 1);
}

// Writes one chain from point `first` to point `last`.
class Chain {
public:
    Chain(std::uint32_t first,
          std::uint32_t last,
          const LabelledOutlines::Segment& label,
          LabelledOutlines& out)
        : first_(first), last_(last), current_(first), label_(label), out_(out) {}

    void pass(const Point& p) {
        if ((p - out_.points[first_]).norm() < kTooShort_px ||
            (p - out_.points[last_]).norm() < kTooShort_px)
            return;
        connect(add_point(p, out_));
    }
    void end() {
        connect(last_);
        out_.chain_ends.push_back(static_cast<std::uint32_t>(out_.segments.size()));
    }

private:
    void connect(std::uint32_t to) {
        label_.from = current_;
        label_.to = to;
        out_.segments.push_back(label_);
        current_ = to;
    }

    std::uint32_t first_;
    std::uint32_t last_;
    std::uint32_t current_;
    LabelledOutlines::Segment label_;
    LabelledOutlines& out_;
};

LabelledOutlines::Segment label(SegmentKind kind, std::uint32_t fg_loop, std::uint32_t bg_loop) {
    return {0, 0, kind, fg_loop, bg_loop};
}

void add_closed(std::span<const Point> loop,
                const LabelledOutlines::Segment& segment,
                LabelledOutlines& out) {
    const std::uint32_t first = add_point(loop.front(), out);
    Chain chain(first, first, segment, out);
    for (const Point& p : loop.subspan(1)) chain.pass(p);
    chain.end();
}

void add_whole_contour(std::span<const Point> loop, LabelledOutlines& out) {
    add_closed(
        loop,
        label(SegmentKind::kSilhouette, out.num_foreground_loops++, out.num_background_loops++),
        out);
}

void add_arc(const Outlines& outlines,
             std::size_t contour,
             std::uint32_t enter,
             FieldScratch& scratch,
             LabelledOutlines& out) {
    number_loops(enter, scratch.crossings, out);
    Crossing& from = scratch.crossings[enter];
    Crossing& to = scratch.crossings[from.partner];
    from.point = add_point(from.at, out);
    to.point = add_point(to.at, out);
    Chain chain(from.point,
                to.point,
                label(SegmentKind::kSilhouette, from.foreground_loop, from.background_loop),
                out);
    const std::uint32_t begin = outlines.begin_of(contour);
    const std::uint32_t n = outlines.ends[contour] - begin;
    std::uint32_t num_passed = (to.contour_edge + n - from.contour_edge) % n;
    // both on one edge in reverse order: the arc runs all the way around the contour
    if (num_passed == 0 && to.along_contour < from.along_contour) num_passed = n;
    for (std::uint32_t i = 1; i <= num_passed; ++i)
        chain.pass(outlines.points[begin + (from.contour_edge - begin + i) % n]);
    chain.end();
}

void add_silhouette(const Outlines& outlines, FieldScratch& scratch, LabelledOutlines& out) {
    std::uint32_t first = 0;
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        const std::uint32_t end = scratch.crossing_ends[c];
        if (first == end && scratch.starts_inside[c]) add_whole_contour(outlines.contour(c), out);
        for (; first < end; ++first) {
            if (scratch.crossings[first].enters) add_arc(outlines, c, first, scratch, out);
        }
    }
}

// Adds the piece of the border from one crossing counter-clockwise to the next. Pieces beside
// background are written in reverse direction.
void add_border_piece(std::size_t index,
                      bool keep_unseen,
                      const FieldScratch& scratch,
                      LabelledOutlines& out) {
    const std::vector<Point>& field = scratch.field;
    const Crossing& from = scratch.crossings[scratch.around[index]];
    const Crossing& to = scratch.crossings[from.after];
    const auto m = static_cast<std::uint32_t>(field.size());
    const bool wraps = index + 1 == scratch.around.size();
    const std::uint32_t num_passed = to.field_edge + (wraps ? m : 0) - from.field_edge;
    if (from.enters) {
        Chain chain(
            to.point, from.point, label(SegmentKind::kOutside, kNone, from.background_loop), out);
        for (std::uint32_t i = num_passed; i > 0; --i) chain.pass(field[(from.field_edge + i) % m]);
        chain.end();
    } else if (keep_unseen) {
        Chain chain(
            from.point, to.point, label(SegmentKind::kUnseen, to.foreground_loop, kNone), out);
        for (std::uint32_t i = 1; i <= num_passed; ++i)
            chain.pass(field[(from.field_edge + i) % m]);
        chain.end();
    }
}

void add_whole_border(bool is_foreground,
                      bool keep_unseen,
                      FieldScratch& scratch,
                      LabelledOutlines& out) {
    if (is_foreground) {
        const std::uint32_t loop = out.num_foreground_loops++;
        if (keep_unseen) add_closed(scratch.field, label(SegmentKind::kUnseen, loop, kNone), out);
        return;
    }
    std::reverse(scratch.field.begin() + 1, scratch.field.end());
    add_closed(scratch.field, label(SegmentKind::kOutside, kNone, out.num_background_loops++), out);
}

}  // namespace

bool is_usable_field(std::span<const Point> field) {
    const std::size_t m = field.size();
    if (m < 3) return false;
    for (const Point& p : field) {
        if (!p.allFinite()) return false;
    }
    const auto at = [&](std::size_t i) -> const Point& { return field[i % m]; };
    for (std::size_t i = 0; i < m; ++i) {
        if (folds_back(at(i), at(i + 1), at(i + 2))) return false;
        for (std::size_t k = i + 2; k < m; ++k) {
            if (i == 0 && k + 1 == m) continue;
            if (segments_touch(at(i), at(i + 1), at(k), at(k + 1))) return false;
        }
    }
    return std::abs(signed_area_px2(field)) > kMinFieldArea_px2;
}

bool cut_by_field(const Outlines& outlines,
                  std::span<const Point> field,
                  bool keep_unseen,
                  FieldScratch& scratch,
                  LabelledOutlines& out) {
    out.clear();
    take_field(field, scratch.field);
    if (!find_crossings(outlines, scratch)) return false;
    order_along_border(scratch);
    if (!is_consistent(outlines, scratch)) return false;
    for (Crossing& x : scratch.crossings) x.foreground_loop = x.background_loop = kNone;
    add_silhouette(outlines, scratch, out);
    for (std::size_t i = 0; i < scratch.around.size(); ++i)
        add_border_piece(i, keep_unseen, scratch, out);
    if (scratch.around.empty()) {
        const bool is_foreground = contains(outlines, scratch.field.front());
        add_whole_border(is_foreground, keep_unseen, scratch, out);
    }
    return true;
}

void label_without_field(const Outlines& outlines, LabelledOutlines& out) {
    out.clear();
    for (std::size_t c = 0; c < outlines.num_contours(); ++c)
        add_whole_contour(outlines.contour(c), out);
}

}  // namespace atrium::hull
