#include "site_node/hull/field_of_view.hpp"

#include "tests/support/allocation_counter.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/unit/hull/labelled_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace atrium::hull {
namespace {

using test::Contour;
using test::Contours;
using test::Point;
using test::prepare;

using enum SegmentKind;
using Segment = LabelledOutlines::Segment;

LabelledOutlines cut(const Contours& contours, const Contour& field, bool keep_unseen = true) {
    FieldScratch scratch;
    LabelledOutlines out;
    EXPECT_TRUE(is_usable_field(field));
    EXPECT_TRUE(cut_by_field(prepare(contours), field, keep_unseen, scratch, out));
    test::expect_sound(out, keep_unseen);
    return out;
}

Contour disk(double x, double y, double radius) {
    return test::regular_polygon({x, y}, radius, 64, 0.01);
}

const Contour kField{{0, 0}, {10, 0}, {10, 10}, {0, 10}};

double length_of(const LabelledOutlines& labelled, SegmentKind kind) {
    double sum = 0.0;
    for (const Segment& s : labelled.segments) {
        if (s.kind == kind) sum += (labelled.points[s.to] - labelled.points[s.from]).norm();
    }
    return sum;
}

using PerKind = std::array<int, 3>;    // silhouette, outside, unseen
using PerFamily = std::array<int, 2>;  // foreground, background

PerKind num_chains(const LabelledOutlines& labelled) {
    PerKind num{};
    for (std::size_t c = 0; c < labelled.num_chains(); ++c) {
        const SegmentKind kind = labelled.segments[labelled.begin_of(c)].kind;
        ++num[kind == kSilhouette ? 0 : kind == kOutside ? 1 : 2];
    }
    return num;
}

PerFamily num_loops(const LabelledOutlines& labelled) {
    return {static_cast<int>(labelled.num_foreground_loops),
            static_cast<int>(labelled.num_background_loops)};
}

// Twice the area to the left of the segments of `loop` in the family (foreground or background).
double loop_area_px2(const LabelledOutlines& labelled, bool foreground, std::uint32_t loop) {
    double twice = 0.0;
    for (const Segment& s : labelled.segments) {
        if ((foreground ? s.foreground_loop : s.background_loop) != loop) continue;
        const Point& a = labelled.points[s.from];
        const Point& b = labelled.points[s.to];
        twice += a.x() * b.y() - a.y() * b.x();
    }
    return (foreground ? 0.5 : -0.5) * twice;
}

TEST(FieldOfView, CutsADiskAtTheBorder) {
    const LabelledOutlines labelled = cut({disk(0, 5, 3)}, kField);
    EXPECT_NEAR(length_of(labelled, kSilhouette), 3.0 * std::numbers::pi, 0.01);
    EXPECT_NEAR(length_of(labelled, kUnseen), 6.0, 0.01);
    EXPECT_NEAR(length_of(labelled, kOutside), 34.0, 0.01);
    EXPECT_EQ(num_chains(labelled), (PerKind{1, 1, 1}));
    ASSERT_EQ(num_loops(labelled), (PerFamily{1, 1}));
    const double half = 4.5 * std::numbers::pi;
    EXPECT_NEAR(loop_area_px2(labelled, true, 0), half, 0.05);
    EXPECT_NEAR(loop_area_px2(labelled, false, 0), 100.0 - half, 0.05);
}

TEST(FieldOfView, OmitsUnseenPiecesOnRequest) {
    const LabelledOutlines all = cut({disk(0, 5, 3)}, kField);
    const LabelledOutlines labelled = cut({disk(0, 5, 3)}, kField, false);
    EXPECT_EQ(num_chains(labelled), (PerKind{1, 1, 0}));
    EXPECT_EQ(num_loops(labelled), (PerFamily{1, 1}));
    EXPECT_EQ(length_of(labelled, kSilhouette), length_of(all, kSilhouette));
    EXPECT_EQ(length_of(labelled, kOutside), length_of(all, kOutside));
}

TEST(FieldOfView, CutsARingIntoOneCellBetweenTwoBackgroundCells) {
    const LabelledOutlines labelled = cut({disk(0, 5, 4), disk(0, 5, 2)}, kField);
    EXPECT_EQ(num_chains(labelled), (PerKind{2, 2, 2}));
    EXPECT_EQ(num_loops(labelled), (PerFamily{1, 2}));
    EXPECT_NEAR(loop_area_px2(labelled, true, 0), 6.0 * std::numbers::pi, 0.05);
}

TEST(FieldOfView, KeepsARingInsideAsTwoLoopsOfEachFamily) {
    const LabelledOutlines labelled = cut({disk(5, 5, 4), disk(5, 5, 2)}, kField);
    EXPECT_EQ(num_chains(labelled), (PerKind{2, 1, 0}));
    EXPECT_EQ(num_loops(labelled), (PerFamily{2, 3}));
}

TEST(FieldOfView, DividesTheBackgroundBesideAPersonOverTwoBorders) {
    const LabelledOutlines labelled = cut({{{4, -2}, {6, -2}, {6, 12}, {4, 12}}}, kField);
    EXPECT_EQ(num_chains(labelled), (PerKind{2, 2, 2}));
    ASSERT_EQ(num_loops(labelled), (PerFamily{1, 2}));
    EXPECT_NEAR(loop_area_px2(labelled, true, 0), 20.0, 1e-4);
    EXPECT_NEAR(loop_area_px2(labelled, false, 0), 40.0, 1e-4);
    EXPECT_NEAR(loop_area_px2(labelled, false, 1), 40.0, 1e-4);
}

TEST(FieldOfView, FollowsTheBorderAroundACornerInTheForeground) {
    const LabelledOutlines labelled = cut({{{7, 8}, {12, 8}, {12, 12}, {7, 12}}}, kField);
    EXPECT_NEAR(length_of(labelled, kSilhouette), 5.0, 1e-4);
    EXPECT_NEAR(length_of(labelled, kUnseen), 5.0, 1e-4);
    EXPECT_NEAR(length_of(labelled, kOutside), 35.0, 1e-4);
    EXPECT_NEAR(loop_area_px2(labelled, true, 0), 6.0, 1e-4);
}

TEST(FieldOfView, IsAllBackgroundWithoutContours) {
    for (const Contours& contours : {Contours{}, Contours{disk(20, 20, 3)}}) {
        const LabelledOutlines labelled = cut(contours, kField);
        EXPECT_EQ(labelled.segments.size(), 4u);
        EXPECT_EQ(num_chains(labelled), (PerKind{0, 1, 0}));
        EXPECT_EQ(num_loops(labelled), (PerFamily{0, 1}));
        EXPECT_NEAR(loop_area_px2(labelled, false, 0), 100.0, 1e-9);
    }
}

TEST(FieldOfView, IsAllForegroundInsideAContour) {
    const LabelledOutlines labelled = cut({disk(5, 5, 20)}, kField);
    EXPECT_EQ(num_chains(labelled), (PerKind{0, 0, 1}));
    EXPECT_EQ(num_loops(labelled), (PerFamily{1, 0}));
    EXPECT_NEAR(loop_area_px2(labelled, true, 0), 100.0, 1e-9);
    EXPECT_TRUE(cut({disk(5, 5, 20)}, kField, false).segments.empty());
}

TEST(FieldOfView, DoesNotDependOnTheFieldsOrderOrOrientation) {
    const Contours contours{disk(0, 5, 4), disk(0, 5, 2), disk(8, 9, 2)};
    Contour turned = kField;
    std::rotate(turned.begin(), turned.begin() + 2, turned.end());
    std::reverse(turned.begin(), turned.end());
    const LabelledOutlines one = cut(contours, kField);
    const LabelledOutlines other = cut(contours, turned);
    EXPECT_EQ(one.points, other.points);
    EXPECT_EQ(one.chain_ends, other.chain_ends);
    ASSERT_EQ(one.segments.size(), other.segments.size());
    for (std::size_t i = 0; i < one.segments.size(); ++i) {
        EXPECT_EQ(one.segments[i].from, other.segments[i].from);
        EXPECT_EQ(one.segments[i].to, other.segments[i].to);
        EXPECT_EQ(one.segments[i].kind, other.segments[i].kind);
    }
}

TEST(FieldOfView, ReportsContradictoryContours) {
    FieldScratch scratch;
    LabelledOutlines out;
    Outlines outlines;  // foreground to the right
    outlines.append(Contour{{-3, 4}, {-3, 6}, {3, 6}, {3, 4}});
    EXPECT_FALSE(cut_by_field(outlines, kField, true, scratch, out));
    EXPECT_TRUE(out.segments.empty());
    outlines.clear();  // two that cross
    outlines.append(Contour{{-3, 4}, {3, 4}, {3, 6}, {-3, 6}});
    outlines.append(Contour{{-3, 5}, {3, 5}, {3, 7}, {-3, 7}});
    EXPECT_FALSE(cut_by_field(outlines, kField, true, scratch, out));
    EXPECT_TRUE(out.segments.empty());
}

TEST(FieldOfView, DoesNotAllocateOnceWarm) {
    const Outlines outlines = prepare({disk(0, 5, 4), disk(0, 5, 2), disk(8, 9, 2)});
    FieldScratch scratch;
    LabelledOutlines out;
    ASSERT_TRUE(cut_by_field(outlines, kField, true, scratch, out));
    label_without_field(outlines, out);
    const auto before = test::num_allocations();
    ASSERT_TRUE(cut_by_field(outlines, kField, true, scratch, out));
    label_without_field(outlines, out);
    EXPECT_EQ(test::num_allocations(), before);
}

TEST(FieldOfView, KeepsContoursAsChainsAndLoopsWithoutAField) {
    const Outlines outlines = prepare({disk(5, 5, 4), disk(5, 5, 2)});
    LabelledOutlines labelled;
    label_without_field(outlines, labelled);
    test::expect_sound(labelled, true);
    EXPECT_EQ(labelled.points, outlines.points);
    EXPECT_EQ(labelled.chain_ends, outlines.ends);
    EXPECT_EQ(labelled.segments.back().foreground_loop, 1u);
    EXPECT_EQ(labelled.segments.back().background_loop, 1u);
    EXPECT_EQ(num_chains(labelled), (PerKind{2, 0, 0}));
    EXPECT_EQ(num_loops(labelled), (PerFamily{2, 2}));
}

TEST(UsableField, IsASimplePolygonWithArea) {
    EXPECT_TRUE(is_usable_field(kField));
    EXPECT_TRUE(is_usable_field(Contour{{0, 0}, {10, 0}, {10, 10}, {5, 1}, {0, 10}}));
    EXPECT_TRUE(is_usable_field(Contour{{0, 0}, {5, 0}, {10, 0}, {0, 10}}));  // straight on
    EXPECT_FALSE(is_usable_field({}));
    EXPECT_FALSE(is_usable_field(Contour{{0, 0}, {10, 0}}));
    EXPECT_FALSE(is_usable_field(Contour{{0, 0}, {10, 0}, {std::nan(""), 10}}));
    EXPECT_FALSE(is_usable_field(Contour{{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
    EXPECT_FALSE(is_usable_field(Contour{{0, 0}, {10, 10}, {10, 0}, {0, 20}}));
    EXPECT_FALSE(is_usable_field(Contour{{0, 0}, {0, 0}, {10, 0}, {10, 10}}));
    // goes back
    EXPECT_FALSE(is_usable_field(Contour{{0, 0}, {10, 0}, {10, 10}, {10, 5}}));
    // touches itself
    EXPECT_FALSE(is_usable_field(Contour{{0, 0}, {10, 0}, {10, 10}, {5, 0}, {0, 10}}));
    EXPECT_FALSE(is_usable_field(Contour{{0, 0}, {10, 0}, {5, 5}, {10, 10}, {0, 10}, {5, 5}}));
}

}  // namespace
}  // namespace atrium::hull
