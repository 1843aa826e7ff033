#include "site_node/silhouette/contours.hpp"

#include "site_node/silhouette/edge_conflicts.hpp"
#include "tests/unit/silhouette/test_masks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace atrium::silhouette {
namespace {

using testing::ElementsAre;

std::int64_t num_cracks(const image::Mask& mask) {
    const auto value = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < mask.width && y < mask.height && mask.at(x, y) != 0;
    };
    std::int64_t cracks = 0;
    for (int y = 0; y <= mask.height; ++y) {
        for (int x = 0; x <= mask.width; ++x) {
            cracks += value(x, y) != value(x - 1, y);
            cracks += value(x, y) != value(x, y - 1);
        }
    }
    return cracks;
}

// Number of 4-connected foreground components, by flood fill.
int num_components(image::Mask mask) {
    int components = 0;
    std::vector<std::pair<int, int>> open;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            ++components;
            open.push_back({x, y});
            while (!open.empty()) {
                const auto [px, py] = open.back();
                open.pop_back();
                if (px < 0 || py < 0 || px >= mask.width || py >= mask.height ||
                    mask.at(px, py) == 0)
                    continue;
                mask.row(py)[px] = 0;
                open.insert(open.end(), {{px + 1, py}, {px - 1, py}, {px, py + 1}, {px, py - 1}});
            }
        }
    }
    return components;
}

double signed_area_of_points(std::span<const GridPoint> points) {
    double twice = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GridPoint a = points[i];
        const GridPoint b = points[(i + 1) % points.size()];
        twice += static_cast<double>(a.x) * b.y - static_cast<double>(a.y) * b.x;
    }
    return 0.125 * twice;
}

TEST(Contours, OfOnePixelAreFourCrackMiddlesWithForegroundOnTheLeft) {
    image::Mask mask(5, 4);
    mask.row(2)[3] = 255;
    ContourSet set;
    trace_contours(mask, 1, set);
    ASSERT_EQ(set.contours.size(), 1u);
    EXPECT_EQ(set.contours[0].area_px, 1);
    EXPECT_FALSE(set.contours[0].touches_border);
    EXPECT_THAT(set.points,
                ElementsAre(GridPoint{6, 3}, GridPoint{7, 4}, GridPoint{6, 5}, GridPoint{5, 4}));
}

TEST(Contours, SplitDiagonalNeighboursAndCloseAtTheBorder) {
    image::Mask mask(2, 2);
    mask.row(0)[0] = mask.row(1)[1] = 255;
    ContourSet set;
    trace_contours(mask, 1, set);
    EXPECT_EQ(set.contours.size(), 2u);
    trace_contours(image::Mask(9, 7, 255), 1, set);
    ASSERT_EQ(set.contours.size(), 1u);
    EXPECT_EQ(set.contours[0].area_px, 63);
    EXPECT_TRUE(set.contours[0].touches_border);
}

TEST(Contours, RunClockwiseAroundHolesAndJoinDiagonalGaps) {
    image::Mask mask(6, 6, 255);
    mask.row(2)[2] = mask.row(3)[3] = 0;
    ContourSet set;
    trace_contours(mask, 1, set);
    ASSERT_EQ(set.contours.size(), 2u);
    EXPECT_EQ(set.contours[1].area_px, -2);
    EXPECT_LT(signed_area_of_points(set.points_of(set.contours[1])), 0.0);
}

TEST(Contours, OmitAndCountSmallBlobsAndHoles) {
    image::Mask mask(40, 40);
    test::draw(mask, {15, 20, 15, 20, 12});
    test::draw(mask, {12, 20, 12, 20, 1.1}, 0);  // a hole of 5 pixels
    test::draw(mask, {18, 20, 18, 20, 3.1}, 0);  // a hole of 29 pixels
    test::draw(mask, {34, 34, 34, 34, 1.1});     // a blob of 5 pixels
    ContourSet set;
    trace_contours(mask, 6, set);
    EXPECT_EQ(set.num_small, 2u);
    EXPECT_EQ(set.contours.size(), 2u);
    trace_contours(mask, 5, set);
    EXPECT_EQ(set.num_small, 0u);
    EXPECT_EQ(set.contours.size(), 4u);
}

TEST(Contours, UseEveryCrackOnceAndKeepTheAreaOnNoise) {
    ContourSet set;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const image::Mask mask = test::noise_mask(61, 43, 0.2 + 0.03 * seed, seed);
        trace_contours(mask, 1, set);
        std::set<std::pair<int, int>> middles;
        std::int64_t area_px = 0;
        int blobs = 0;
        for (const Contour& contour : set.contours) {
            area_px += contour.area_px;
            blobs += contour.area_px > 0;
            for (const GridPoint p : set.points_of(contour)) middles.insert({p.x, p.y});
            const double expected =
                static_cast<double>(contour.area_px) + (contour.area_px > 0 ? -0.5 : 0.5);
            EXPECT_DOUBLE_EQ(signed_area_of_points(set.points_of(contour)), expected);
        }
        EXPECT_EQ(static_cast<std::int64_t>(middles.size()), num_cracks(mask));
        EXPECT_EQ(middles.size(), set.points.size());
        EXPECT_EQ(area_px, test::num_foreground(mask));
        EXPECT_EQ(blobs, num_components(mask));
    }
}

TEST(Contours, NeverTouchThemselvesOrEachOther) {
    ContourSet set;
    EdgeGrid grid;
    std::vector<EdgeConflict> conflicts;
    for (unsigned seed = 0; seed < 10; ++seed) {
        trace_contours(test::noise_mask(50, 50, 0.5, seed), 1, set);
        std::vector<SilhouettePolygon> polygons(set.contours.size());
        for (std::size_t c = 0; c < polygons.size(); ++c) {
            for (const GridPoint p : set.points_of(set.contours[c])) {
                polygons[c].vertices_px.emplace_back(0.5 * p.x, 0.5 * p.y);
            }
        }
        find_conflicts(polygons, grid, conflicts);
        EXPECT_TRUE(conflicts.empty());
    }
}

TEST(Contours, StartAtAVertexOfTheirConvexHull) {
    const image::Mask mask = test::person_mask();
    ContourSet set;
    trace_contours(mask, 100, set);
    ASSERT_EQ(set.contours.size(), 2u);
    const auto outer = set.points_of(set.contours[0]);
    for (const GridPoint p : outer)
        EXPECT_TRUE(p.y > outer[0].y || (p.y == outer[0].y && p.x >= outer[0].x));
    const auto hole = set.points_of(set.contours[1]);
    for (const GridPoint p : hole)
        EXPECT_TRUE(p.y < hole[0].y || (p.y == hole[0].y && p.x <= hole[0].x));
}

TEST(Contours, StampsSurviveManyCallsAndSizeChanges) {
    const image::Mask small = test::noise_mask(20, 20, 0.5, 1);
    const image::Mask large = test::noise_mask(33, 27, 0.5, 2);
    ContourSet fresh_small;
    trace_contours(small, 1, fresh_small);
    ContourSet reused;
    for (int i = 0; i < 600; ++i) trace_contours(large, 1, reused);
    for (int i = 0; i < 600; ++i) {
        trace_contours(small, 1, reused);
        ASSERT_EQ(reused.points, fresh_small.points);
    }
}

TEST(Contours, BoundingRectangleHoldsTheirInside) {
    ContourSet set;
    trace_contours(image::Mask(30, 20), 1, set);
    EXPECT_TRUE(bounding_rect(set).empty());
    for (unsigned seed = 0; seed < 30; ++seed) {
        image::Mask mask = test::noise_mask(31, 22, 0.01, seed);
        mask.row(static_cast<int>(seed) % 22)[seed] = 255;  // also at the border
        image::PixelRect truth{31, 22, 0, 0};
        int right = 0;
        int bottom = 0;
        for (int y = 0; y < mask.height; ++y) {
            for (int x = 0; x < mask.width; ++x) {
                if (mask.at(x, y) == 0) continue;
                truth.x = std::min(truth.x, x);
                truth.y = std::min(truth.y, y);
                right = std::max(right, x + 1);
                bottom = std::max(bottom, y + 1);
            }
        }
        truth.width = right - truth.x;
        truth.height = bottom - truth.y;
        trace_contours(mask, 1, set);
        EXPECT_EQ(bounding_rect(set), truth) << "seed " << seed;
    }
}

}  // namespace
}  // namespace atrium::silhouette
