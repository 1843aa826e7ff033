#include "site_node/hull/outlines.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace atrium::hull {
namespace {

using Contour = std::vector<Eigen::Vector2d>;

constexpr double kMinArea_px2 = 0.01;
constexpr std::uint64_t kManyTests = 1'000'000;

class OutlinesTest : public testing::Test {
protected:
    Outlines prepare(const std::vector<Contour>& contours) {
        Outlines outlines;
        counts_ = {};
        copy_canonical(contours, kMinArea_px2, scratch_, outlines, counts_);
        EXPECT_TRUE(make_simple(outlines, kMinArea_px2, kManyTests, scratch_, counts_));
        orient_by_nesting(outlines);
        return outlines;
    }
    static double total_area(const Outlines& outlines) {
        double sum = 0.0;
        for (std::size_t c = 0; c < outlines.num_contours(); ++c)
            sum += signed_area_px2(outlines.contour(c));
        return sum;
    }
    OutlineScratch scratch_;
    OutlineCounts counts_;
};

const Contour kSquare{{0, 0}, {10, 0}, {10, 10}, {0, 10}};

TEST_F(OutlinesTest, SplitsAFigureEightIntoItsTwoLoops) {
    const Outlines outlines = prepare({{{0, 0}, {10, 10}, {10, 0}, {0, 10}}});
    EXPECT_EQ(outlines.num_contours(), 2u);
    EXPECT_EQ(counts_.repaired, 1u);
    EXPECT_EQ(counts_.dropped, 0u);
    EXPECT_NEAR(total_area(outlines), 50.0, 0.1);
    EXPECT_TRUE(contains(outlines, {1.0, 5.0}));
    EXPECT_TRUE(contains(outlines, {9.0, 5.0}));
    EXPECT_FALSE(contains(outlines, {5.0, 1.0}));
}

TEST_F(OutlinesTest, DropsTheTinyLoopOfASimplifiedCorner) {
    const Outlines outlines =
        prepare({{{0, 0}, {10, 0}, {10, 10.02}, {9.98, 9.97}, {10.05, 10}, {0, 10}}});
    EXPECT_EQ(outlines.num_contours(), 1u);
    EXPECT_NEAR(total_area(outlines), 100.0, 0.5);
}

TEST_F(OutlinesTest, JoinsTwoCrossingLoopsAndCutsOutTheirOverlap) {
    const Outlines outlines = prepare({kSquare, {{8, 8}, {12, 8}, {12, 12}, {8, 12}}});
    EXPECT_EQ(outlines.num_contours(), 2u);  // joined at one crossing, split at the other
    EXPECT_EQ(counts_.dropped, 0u);
    EXPECT_EQ(counts_.repaired, 2u);
    EXPECT_NEAR(total_area(outlines), 100.0 - 4.0 + 16.0 - 4.0, 0.02);
    EXPECT_TRUE(contains(outlines, {11.0, 11.0}));
    EXPECT_TRUE(contains(outlines, {7.0, 7.0}));
    EXPECT_FALSE(contains(outlines, {9.0, 9.0}));
}

TEST_F(OutlinesTest, DoNotDependOnOrderStartOrOrientation) {
    // no signed area, the lowest point twice, and repeated points to choose from
    const Contour eight{{0, 0}, {10, 10}, {10, 10.00006}, {10, 10.00012}, {10, 0}, {0, 10}};
    const Contour pinched{{20, 0}, {25, 5}, {22, 9}, {20, 0}, {18, 9}, {15, 5}};
    const Contour turned{{10, 0}, {10, 10.00012}, {10, 10.00006}, {10, 10}, {0, 0}, {0, 10}};
    const Contour rotated{{20, 0}, {22, 9}, {25, 5}, {20, 0}, {15, 5}, {18, 9}};
    const Outlines one = prepare({eight, pinched});
    const Outlines other = prepare({rotated, turned});
    EXPECT_EQ(one.points, other.points);
    EXPECT_EQ(one.ends, other.ends);
}

TEST_F(OutlinesTest, OmitLoopsOutsideABox) {
    const Contour hole{{2, 2}, {2, 8}, {8, 8}, {8, 2}};
    const Contour far{{20, 0}, {30, 0}, {30, 10}};
    Outlines outlines = prepare({far, kSquare, hole});
    ASSERT_EQ(outlines.num_contours(), 3u);
    const Eigen::AlignedBox2d box(Eigen::Vector2d(-5.0, 4.0), Eigen::Vector2d(1.0, 5.0));
    EXPECT_EQ(drop_outside(outlines, box), 2u);
    ASSERT_EQ(outlines.num_contours(), 1u);
    EXPECT_EQ(outlines.points.size(), 4u);
    EXPECT_NEAR(total_area(outlines), 100.0, 1e-9);
    EXPECT_EQ(drop_outside(outlines, box), 0u);
    EXPECT_EQ(drop_outside(outlines, Eigen::AlignedBox2d()), 1u);
    EXPECT_TRUE(outlines.points.empty());
}

TEST_F(OutlinesTest, RemovesRepeatedPointsAndSpikes) {
    const Outlines outlines =
        prepare({{{0, 0}, {0, 0}, {10, 0}, {10, 5}, {15, 5}, {10, 5}, {10, 10}, {0, 10}, {0, 0}}});
    ASSERT_EQ(outlines.num_contours(), 1u);
    EXPECT_NEAR(total_area(outlines), 100.0, 1e-9);
    EXPECT_LE(outlines.points.size(), 5u);
}

TEST_F(OutlinesTest, OrientsHolesAgainstTheirParentAtAnyDepth) {
    const Contour hole{{2, 2}, {2, 8}, {8, 8}, {8, 2}};
    const Contour island{{4, 4}, {6, 4}, {6, 6}, {4, 6}};
    const Outlines outlines = prepare({island, hole, kSquare});
    EXPECT_NEAR(total_area(outlines), 100.0 - 36.0 + 4.0, 1e-9);
    EXPECT_TRUE(contains(outlines, {5.0, 5.0}));
    EXPECT_FALSE(contains(outlines, {3.0, 5.0}));
}

class Scribble : public OutlinesTest {
protected:
    void SetUp() override {
        Contour scribble;
        for (int i = 0; i < 4000; ++i) {
            scribble.emplace_back(100.0 * std::sin(i * 2.399), 100.0 * std::cos(i * 1.733));
        }
        copy_canonical({scribble}, kMinArea_px2, scratch_, outlines_, counts_);
        ASSERT_EQ(outlines_.num_contours(), 1u);
    }
    Outlines outlines_;
};

TEST_F(Scribble, IsAbandonedAfterTheAllowedNumberOfTests) {
    EXPECT_FALSE(make_simple(outlines_, kMinArea_px2, 50, scratch_, counts_));
}

TEST_F(Scribble, IsReducedToLoopsWithoutCrossings) {
    ASSERT_TRUE(make_simple(outlines_, kMinArea_px2, kManyTests, scratch_, counts_));
    EXPECT_GT(counts_.repaired, 0u);
    const Outlines once = outlines_;
    OutlineCounts again;
    ASSERT_TRUE(make_simple(outlines_, kMinArea_px2, kManyTests, scratch_, again));
    EXPECT_EQ(again.repaired + again.dropped, 0u);
    EXPECT_EQ(outlines_.points, once.points);
}

TEST_F(OutlinesTest, JitterIsRepeatableSmallAndDependsOnTheSeed) {
    Outlines a = prepare({kSquare});
    Outlines b = a;
    Outlines c = a;
    const Outlines original = a;
    jitter(a, 1e-3, 1);
    jitter(b, 1e-3, 1);
    jitter(c, 1e-3, 2);
    EXPECT_EQ(a.points, b.points);
    EXPECT_NE(a.points, c.points);
    for (std::size_t i = 0; i < a.points.size(); ++i) {
        const double moved = (a.points[i] - original.points[i]).cwiseAbs().maxCoeff();
        EXPECT_GT(moved, 0.0);
        EXPECT_LE(moved, 1e-3);
    }
}

}  // namespace
}  // namespace atrium::hull
