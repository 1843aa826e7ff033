#include "site_node/silhouette/blurred_segments.hpp"

#include "tests/unit/silhouette/test_masks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::silhouette {
namespace {

// Isothetic thickness [px] by its definition: the least over all strips through two of the points.
double thickness_px(std::span<const GridPoint> points) {
    double best = 1e30;
    for (const GridPoint a : points) {
        for (const GridPoint b : points) {
            const double dx = b.x - a.x;
            const double dy = b.y - a.y;
            if (dx == 0.0 && dy == 0.0) continue;
            double low = 0.0;
            double high = 0.0;
            for (const GridPoint p : points) {
                const double c = dx * (p.y - a.y) - dy * (p.x - a.x);
                low = std::min(low, c);
                high = std::max(high, c);
            }
            best = std::min(best, 0.5 * (high - low) / std::max(std::abs(dx), std::abs(dy)));
        }
    }
    return points.size() < 2 ? 0.0 : best;
}

std::vector<GridPoint> noisy_line(double slope, int noise, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> deviation(-noise, noise);
    std::vector<GridPoint> points;
    for (int x = 0; x < 40; ++x)
        points.push_back({x, static_cast<int>(std::lround(slope * x)) + deviation(random)});
    return points;
}

TEST(BlurredSegment, GrowsExactlyUpToTheThickness) {
    BlurredSegment segment;
    for (unsigned seed = 0; seed < 60; ++seed) {
        const std::vector<GridPoint> points =
            noisy_line(0.05 * seed - 1.5, 1 + static_cast<int>(seed % 4), seed);
        for (const double limit_px : {0.5, 1.0, 1.25, 2.0}) {
            segment.set_thickness_px(limit_px);
            segment.restart(points[0]);
            std::size_t accepted = 1;
            while (accepted < points.size() && segment.add(points[accepted])) ++accepted;
            EXPECT_LE(thickness_px({points.data(), accepted}), limit_px + 1e-9) << "seed " << seed;
            if (accepted == points.size()) continue;
            EXPECT_GT(thickness_px({points.data(), accepted + 1}), limit_px + 1e-9);
        }
    }
}

TEST(BlurredSegment, IncludesTheLimit) {
    const std::vector<GridPoint> points = {
        {0, 0}, {2, 1}, {4, 2}, {5, 0}, {8, 2}, {10, 0}};  // 1 px = 2 units thick
    BlurredSegment segment;
    segment.set_thickness_px(1.0);
    segment.restart(points[0]);
    for (std::size_t i = 1; i < points.size(); ++i) EXPECT_TRUE(segment.add(points[i])) << i;
    segment.set_thickness_px(1.0 - 1.0 / 64.0);
    segment.restart(points[0]);
    bool all = true;
    for (std::size_t i = 1; i < points.size() && all; ++i) all = segment.add(points[i]);
    EXPECT_FALSE(all);
}

TEST(BlurredSegment, GrowsItsHullStoreForLongNoisyPaths) {
    BlurredSegment segment;
    segment.set_thickness_px(1e6);
    // a parabola: every point is a corner of the hull
    segment.restart({0, 0});
    for (int x = 1; x < 2000; ++x) EXPECT_TRUE(segment.add({x, x * x}));
}

TEST(BlurredSegments, MakeOneSegmentOfEveryHalfPlaneEdgeAtOnePixel) {
    ContourSet set;
    BlurredSegment segment;
    segment.set_thickness_px(1.0);
    for (int degrees = 0; degrees < 90; degrees += 3) {
        image::Mask mask(200, 200);
        const double angle = degrees * 3.14159265358979 / 180.0;
        for (int y = 0; y < 200; ++y) {
            for (int x = 0; x < 200; ++x) {
                if (std::cos(angle) * (x - 99.7) + std::sin(angle) * (y - 100.2) < 0.0)
                    mask.row(y)[x] = 255;
            }
        }
        trace_contours(mask, 1, set);
        // keep only the cracks of the edge inside the picture, in their order
        std::vector<GridPoint> edge;
        const auto all = set.points_of(set.contours[0]);
        const auto inside = [](GridPoint p) {
            return p.x > -1 && p.y > -1 && p.x < 399 && p.y < 399;
        };
        std::size_t first = 0;
        while (!inside(all[first]) || inside(all[(first + all.size() - 1) % all.size()])) ++first;
        for (std::size_t i = first; inside(all[i % all.size()]); ++i)
            edge.push_back(all[i % all.size()]);
        edge.push_back(edge.back());  // `last` of the split is cyclic
        std::vector<std::uint32_t> breaks;
        split_into_blurred_segments(edge, 0, edge.size() - 2, segment, breaks);
        EXPECT_EQ(breaks.size(), 1u) << degrees << " degrees";
    }
}

TEST(BlurredSegments, AreThinEnoughAndAsLongAsPossible) {
    std::mt19937 random(7);
    image::Mask mask = test::person_mask();
    test::roughen(mask, 0.2, random);
    ContourSet set;
    trace_contours(mask, 100, set);
    BlurredSegment segment;
    for (const double tolerance_px : {0.5, 1.0, 2.0}) {
        segment.set_thickness_px(tolerance_px);
        const auto points = set.points_of(set.contours[1]);
        std::vector<std::uint32_t> breaks;
        split_into_blurred_segments(points, 0, points.size(), segment, breaks);
        ASSERT_EQ(breaks.front(), 0u);
        breaks.push_back(static_cast<std::uint32_t>(points.size()) - 1);
        for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
            const std::size_t size = breaks[k + 1] - breaks[k] + 1;
            EXPECT_LE(thickness_px(points.subspan(breaks[k], size)), tolerance_px + 1e-9);
            if (k + 2 == breaks.size()) continue;
            EXPECT_GT(thickness_px(points.subspan(breaks[k], size + 1)), tolerance_px + 1e-9);
        }
    }
}

}  // namespace
}  // namespace atrium::silhouette
