#include "site_node/hull/field_of_view.hpp"
#include "tests/unit/hull/labelled_checks.hpp"

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

// A star-shaped polygon, mostly concave. Some are snapped to a lattice and touch the contours.
Contour random_field(HostileContours& random) {
    const Point centre(random.uniform(0, 8), random.uniform(0, 8));
    const int n = 3 + random.index(9);
    const bool on_lattice = random.index(3) == 0;
    Contour field;
    for (int i = 0; i < n; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + random.uniform(0, 0.7)) / n;
        const Point p = centre + random.uniform(1.0, 9.0) * Point(std::cos(angle), std::sin(angle));
        field.push_back(on_lattice ? Point(p.array().round()) : p);
    }
    if (random.index(2) == 0) std::reverse(field.begin(), field.end());
    return field;
}

class AnyField : public testing::TestWithParam<int> {};

TEST_P(AnyField, DividesThePlaneAsTheContoursDo) {
    constexpr int kPerCase = 50;
    FieldScratch scratch;
    LabelledOutlines labelled;
    LabelledOutlines without_unseen;
    int num_usable = 0;
    for (int seed = GetParam() * kPerCase; seed < (GetParam() + 1) * kPerCase; ++seed) {
        HostileContours random(static_cast<std::uint32_t>(seed));
        const Contours contours = random.make();
        const Contour field = random_field(random);
        if (!is_usable_field(field)) continue;
        ++num_usable;
        const Outlines outlines = test::prepare(contours);
        ASSERT_TRUE(cut_by_field(outlines, field, true, scratch, labelled)) << seed;
        ASSERT_TRUE(cut_by_field(outlines, field, false, scratch, without_unseen)) << seed;
        test::expect_sound(labelled, true);
        test::expect_sound(without_unseen, false);
        for (int k = 0; k < 200; ++k) {
            const Point p(random.uniform(-12, 16), random.uniform(-12, 16));
            if (distance_to_edges(contours, p) < 0.01 || distance_to_edges({field}, p) < 0.01)
                continue;
            const test::Cell expected = !even_odd({field}, p)   ? test::Cell::kUnknown
                                        : even_odd(contours, p) ? test::Cell::kForeground
                                                                : test::Cell::kBackground;
            ASSERT_EQ(test::cell_of(labelled, p), expected) << seed << " at " << p.transpose();
            ASSERT_EQ(test::is_background(without_unseen, p), expected == test::Cell::kBackground)
                << seed;
        }
        ASSERT_FALSE(HasFailure()) << seed;
    }
    EXPECT_GE(num_usable, 30);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AnyField, testing::Range(0, 10));

}  // namespace
}  // namespace atrium::hull
