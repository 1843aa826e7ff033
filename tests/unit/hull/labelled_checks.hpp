#pragma once

#include "site_node/hull/field_of_view.hpp"
#include "tests/unit/hull/hostile_contours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace atrium::test {

using hull::LabelledOutlines;
using hull::Outlines;
using hull::SegmentKind;

/// Jittered, simple, oriented.
inline Outlines prepare(const Contours& contours) {
    Outlines outlines;
    hull::OutlineScratch scratch;
    hull::OutlineCounts counts;
    copy_canonical(contours, 0.0, scratch, outlines, counts);
    jitter(outlines, 1e-6, 5);
    EXPECT_TRUE(make_simple(outlines, 3e-4, 100'000'000, scratch, counts));
    orient_by_nesting(outlines);
    return outlines;
}

/// Checks the invariants of `LabelledOutlines` for chains, junctions and loops.
inline void expect_sound(const LabelledOutlines& labelled, bool keep_unseen) {
    std::vector<int> num_in(labelled.points.size());
    std::vector<int> num_out(labelled.points.size());
    std::map<std::pair<bool, std::uint32_t>, std::map<std::uint32_t, int>> balance;
    std::map<std::uint32_t, std::set<SegmentKind>> meeting;
    std::size_t begin = 0;
    for (const std::uint32_t end : labelled.chain_ends) {
        ASSERT_LT(begin, end);
        const std::uint32_t first = labelled.segments[begin].from;
        const std::uint32_t last = labelled.segments[end - 1].to;
        for (std::size_t i = begin; i < end; ++i) {
            const LabelledOutlines::Segment& s = labelled.segments[i];
            ASSERT_LT(std::max(s.from, s.to), labelled.points.size());
            EXPECT_NE(s.from, s.to);
            EXPECT_EQ(s.kind, labelled.segments[begin].kind);
            if (i > begin) {
                EXPECT_EQ(s.from, labelled.segments[i - 1].to);
                EXPECT_EQ(s.foreground_loop, labelled.segments[i - 1].foreground_loop);
                EXPECT_EQ(s.background_loop, labelled.segments[i - 1].background_loop);
                ++num_in[s.from];  // passed inside a chain
                ++num_out[s.from];
            }
            EXPECT_EQ(s.foreground_loop == LabelledOutlines::kNoLoop,
                      s.kind == SegmentKind::kOutside);
            EXPECT_EQ(s.background_loop == LabelledOutlines::kNoLoop,
                      s.kind == SegmentKind::kUnseen);
            if (s.kind != SegmentKind::kOutside) {
                EXPECT_LT(s.foreground_loop, labelled.num_foreground_loops);
                ++balance[{true, s.foreground_loop}][s.from];
                --balance[{true, s.foreground_loop}][s.to];
            }
            if (s.kind != SegmentKind::kUnseen) {
                EXPECT_LT(s.background_loop, labelled.num_background_loops);
                ++balance[{false, s.background_loop}][s.from];
                --balance[{false, s.background_loop}][s.to];
            }
        }
        if (first == last) {
            ++num_in[first];
        } else {
            meeting[first].insert(labelled.segments[begin].kind);
            meeting[last].insert(labelled.segments[begin].kind);
        }
        begin = end;
    }
    EXPECT_EQ(begin, labelled.segments.size());
    for (std::uint32_t p = 0; p < labelled.points.size(); ++p) {
        // either one chain passes each point, or the point is a junction with one end of each kind
        const auto it = meeting.find(p);
        EXPECT_EQ(num_in[p], it == meeting.end() ? 1 : 0);
        if (it != meeting.end()) {
            EXPECT_EQ(it->second.size(), keep_unseen ? 3u : 2u);
        }
    }
    std::size_t num_foreground = 0;
    std::size_t num_background = 0;
    for (const auto& [loop, at_point] : balance) {
        (loop.first ? num_foreground : num_background) += 1;
        if (loop.first && !keep_unseen) continue;
        for (const auto& [point, sum] : at_point) EXPECT_EQ(sum, 0) << "loop is open";
    }
    EXPECT_EQ(num_background, labelled.num_background_loops);
    if (keep_unseen) {
        EXPECT_EQ(num_foreground, labelled.num_foreground_loops);
    }
}

enum class Cell { kForeground, kBackground, kUnknown };

/// Follows the ray from infinity to p. Each segment must be entered from the cell that it names.
inline Cell cell_of(const LabelledOutlines& labelled, const Point& p) {
    struct Hit {
        double x;
        Cell far, near;
    };
    std::vector<Hit> hits;
    for (const LabelledOutlines::Segment& s : labelled.segments) {
        const Point& a = labelled.points[s.from];
        const Point& b = labelled.points[s.to];
        if ((a.y() > p.y()) == (b.y() > p.y())) continue;
        const double x = a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
        if (x <= p.x()) continue;
        const Cell left = s.kind == SegmentKind::kOutside ? Cell::kUnknown : Cell::kForeground;
        const Cell right = s.kind == SegmentKind::kUnseen ? Cell::kUnknown : Cell::kBackground;
        const bool rising = b.y() > a.y();  // the rest has smaller x
        hits.push_back({x, rising ? right : left, rising ? left : right});
    }
    std::sort(hits.begin(), hits.end(), [](const Hit& l, const Hit& r) { return l.x > r.x; });
    Cell cell = Cell::kUnknown;
    for (const Hit& hit : hits) {
        EXPECT_EQ(hit.far, cell);
        cell = hit.near;
    }
    return cell;
}

/// Like the above, without kUnseen segments: whether p is background, by the number of borders
/// passed.
inline bool is_background(const LabelledOutlines& labelled, const Point& p) {
    bool inside = false;
    for (const LabelledOutlines::Segment& s : labelled.segments) {
        const Point& a = labelled.points[s.from];
        const Point& b = labelled.points[s.to];
        if ((a.y() > p.y()) == (b.y() > p.y())) continue;
        if (a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()) > p.x()) inside = !inside;
    }
    return inside;
}

}  // namespace atrium::test
