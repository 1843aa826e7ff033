#include "site_node/hull/outlines.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/unit/hull/hostile_contours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::hull {
namespace {

using test::Contour;
using test::Contours;
using test::distance_to_edges;
using test::even_odd;
using test::HostileContours;
using test::Point;

constexpr double kJitter_px = 1e-6;
constexpr double kFarFromEdges_px = 0.01;
// a loop with less area contains no point that far from its edges
constexpr double kTinyArea_px2 = 3e-4;
constexpr std::uint64_t kEnoughTests = 100'000'000;

// The test's own reference, independent of the code under test.
double turn(const Point& a, const Point& b, const Point& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool properly_cross(const Point& a, const Point& b, const Point& c, const Point& d) {
    return turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
}

int num_crossings(const Outlines& outlines) {
    struct Segment {
        Point a, b;
        std::size_t contour, index, size;
    };
    std::vector<Segment> all;
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        const auto loop = outlines.contour(c);
        for (std::size_t i = 0; i < loop.size(); ++i)
            all.push_back({loop[i], loop[(i + 1) % loop.size()], c, i, loop.size()});
    }
    int num = 0;
    for (const Segment& s : all) {
        for (const Segment& t : all) {
            const bool adjacent = s.contour == t.contour && ((s.index + 1) % s.size == t.index ||
                                                             (t.index + 1) % s.size == s.index);
            if (&s < &t && !adjacent && properly_cross(s.a, s.b, t.a, t.b)) ++num;
        }
    }
    return num;
}

Outlines repaired(const Contours& contours, OutlineScratch& scratch, OutlineCounts& counts) {
    Outlines outlines;
    copy_canonical(contours, 0.0, scratch, outlines, counts);
    jitter(outlines, kJitter_px, 7);
    EXPECT_TRUE(make_simple(outlines, kTinyArea_px2, kEnoughTests, scratch, counts));
    return outlines;
}

class HostileOutlines : public testing::TestWithParam<int> {
protected:
    static constexpr int kPerCase = 60;
    OutlineScratch scratch_;
};

TEST_P(HostileOutlines, BecomeSimpleAndEncloseTheSame) {
    for (int i = 0; i < kPerCase; ++i) {
        HostileContours hostile(static_cast<std::uint32_t>(GetParam() * kPerCase + i));
        const Contours contours = hostile.make();
        OutlineCounts counts;
        const Outlines outlines = repaired(contours, scratch_, counts);
        ASSERT_EQ(num_crossings(outlines), 0) << "seed " << GetParam() * kPerCase + i;
        for (int k = 0; k < 400; ++k) {
            Point p(hostile.uniform(-12, 16), hostile.uniform(-12, 16));
            if (k % 2 == 0) {  // close to the edges
                const Contour& any =
                    contours[static_cast<std::size_t>(hostile.index(std::ssize(contours)))];
                const auto n = static_cast<int>(any.size());
                const auto at = static_cast<std::size_t>(hostile.index(n));
                const Point& a = any[at];
                const Point& b = any[(at + 1) % any.size()];
                p = a + hostile.uniform(0, 1) * (b - a) +
                    Point(hostile.uniform(-0.05, 0.05), hostile.uniform(-0.05, 0.05));
            }
            if (distance_to_edges(contours, p) <= kFarFromEdges_px) continue;
            ASSERT_EQ(contains(outlines, p), even_odd(contours, p))
                << "seed " << GetParam() * kPerCase + i << " at " << p.transpose();
        }
    }
}

TEST_P(HostileOutlines, DoNotDependOnOrderOrOrientation) {
    for (int i = 0; i < kPerCase; ++i) {
        HostileContours hostile(static_cast<std::uint32_t>(GetParam() * kPerCase + i));
        Contours contours = hostile.make();
        OutlineCounts counts;
        const Outlines once = repaired(contours, scratch_, counts);
        for (Contour& contour : contours) {
            if (hostile.index(2) == 0) std::reverse(contour.begin(), contour.end());
            const auto n = static_cast<int>(contour.size());
            std::rotate(contour.begin(), contour.begin() + hostile.index(n), contour.end());
        }
        std::rotate(contours.begin(),
                    contours.begin() + hostile.index(static_cast<int>(contours.size())),
                    contours.end());
        OutlineCounts counts_again;
        const Outlines again = repaired(contours, scratch_, counts_again);
        ASSERT_EQ(once.points, again.points) << "seed " << GetParam() * kPerCase + i;
        ASSERT_EQ(once.ends, again.ends);
        ASSERT_EQ(counts.repaired, counts_again.repaired);
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, HostileOutlines, testing::Range(0, 10));

Contours noisy_disk(int num_points, double noise_px) {
    HostileContours hostile(3);
    Contour contour;
    for (int i = 0; i < num_points; ++i) {
        const double angle = i * 2.0 * std::numbers::pi / num_points;
        contour.push_back(
            Point(500, 500) + 300.0 * Point(std::cos(angle), std::sin(angle)) +
            Point(hostile.uniform(-noise_px, noise_px), hostile.uniform(-noise_px, noise_px)));
    }
    return {contour};
}

TEST(OutlineRepair, NeedsFewTestsForManyCrossings) {
    OutlineScratch scratch;
    OutlineCounts counts;
    Outlines outlines;
    copy_canonical(noisy_disk(600, 8.0), 0.01, scratch, outlines, counts);
    jitter(outlines, kJitter_px, 7);
    EXPECT_TRUE(make_simple(outlines, 0.01, 60'000, scratch, counts));
    EXPECT_GT(counts.repaired, 100u);
    EXPECT_EQ(num_crossings(outlines), 0);
    orient_by_nesting(outlines);
    double area = 0.0;
    for (std::size_t c = 0; c < outlines.num_contours(); ++c)
        area += signed_area_px2(outlines.contour(c));
    EXPECT_NEAR(area, 282'743.0, 3'000.0);
}

TEST(OutlineRepair, DoesNotAllocateOnceWarm) {
    OutlineScratch scratch;
    const Contours contours = noisy_disk(600, 4.0);
    Outlines outlines;
    const auto repair = [&] {
        OutlineCounts counts;
        copy_canonical(contours, 0.01, scratch, outlines, counts);
        jitter(outlines, kJitter_px, 7);
        EXPECT_TRUE(make_simple(outlines, 0.01, kEnoughTests, scratch, counts));
    };
    for (int i = 0; i < 2; ++i) repair();  // two arrays are swapped
    const auto before = test::num_allocations();
    repair();
    EXPECT_EQ(test::num_allocations(), before);
}

TEST(OutlineRepair, DropsOnlyLoopsThatStillCrossWhenRepairsRunOut) {
    // two crossing combs: 1600 crossings
    Contour comb;
    for (int i = 0; i < 20; ++i) {
        comb.insert(comb.end(), {{2.0 * i, 0.0}, {2.0 * i + 0.5, 50.0}, {2.0 * i + 1.0, 0.0}});
    }
    comb.insert(comb.end(), {{40.0, -60.0}, {0.0, -60.0}});
    Contour across;
    for (int i = 0; i < 20; ++i) {
        across.insert(across.end(),
                      {{-2.0, 2.0 * i + 1.0}, {45.0, 2.0 * i + 1.5}, {-2.0, 2.0 * i + 2.0}});
    }
    across.insert(across.end(), {{-4.0, 40.0}, {-4.0, 1.0}});
    OutlineScratch scratch;
    OutlineCounts counts;
    const Contour apart{{60.0, 0.0}, {70.0, 0.0}, {70.0, 50.0}, {60.0, 50.0}};
    const Outlines outlines = repaired({comb, across, apart}, scratch, counts);
    EXPECT_EQ(counts.repaired, 1000u);
    EXPECT_GT(counts.dropped, 0u);
    EXPECT_EQ(num_crossings(outlines), 0);
    EXPECT_TRUE(contains(outlines, {65.0, 20.0}));
    EXPECT_FALSE(contains(outlines, {55.0, 20.0}));
}

}  // namespace
}  // namespace atrium::hull
