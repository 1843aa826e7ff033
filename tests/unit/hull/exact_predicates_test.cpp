#include "site_node/hull/exact_predicates.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <gtest/gtest.h>

#include <array>
#include <random>

// Compares the predicates with fractions of unlimited length from the definitions, for numbers up
// to the largest allowed.
namespace atrium::hull::exact {
namespace {

using Fraction = boost::multiprecision::cpp_rational;
using Big = std::array<Fraction, 3>;
using Random = std::mt19937_64;

constexpr std::int64_t kRay = std::int64_t{1} << 37;
constexpr std::int64_t kBaseline = std::int64_t{1} << 45;

static_assert(kRay == static_cast<std::int64_t>(kMaxRay));
static_assert(kBaseline == 2 * static_cast<std::int64_t>(kMaxCentre));

Big big(const Vector& v) { return {Fraction(v[0]), Fraction(v[1]), Fraction(v[2])}; }
Fraction dot(const Big& a, const Big& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Big cross(const Big& a, const Big& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
int sign(const Fraction& f) { return f.sign(); }

Vector random_vector(Random& random, std::int64_t limit) {
    // makes small numbers and the largest ones meet more often than by chance
    const auto component = [&]() -> std::int64_t {
        switch (std::uniform_int_distribution<int>(0, 5)(random)) {
            case 0:
                return limit;
            case 1:
                return -limit;
            case 2:
                return std::uniform_int_distribution<std::int64_t>(-2, 2)(random);
            default:
                return std::uniform_int_distribution<std::int64_t>(-limit, limit)(random);
        }
    };
    return {component(), component(), component()};
}

// A strip and three others that cut it. None of their planes goes through this strip's camera.
struct Setting {
    Vector own_from, own_to;
    std::array<Vector, 4> from, to, offset;  // other strips; this centre minus theirs
    std::array<Line, 4> lines;

    explicit Setting(Random& random)
        : own_from(random_vector(random, kRay)), own_to(random_vector(random, kRay)) {
        for (std::size_t i = 0; i < lines.size(); ++i) {
            do {
                from[i] = random_vector(random, kRay);
                to[i] = random_vector(random, kRay);
                offset[i] = random_vector(random, kBaseline);
                lines[i] = line_of(from[i], to[i], own_from, own_to, offset[i]);
            } while (lines[i].offset == 0);
        }
    }
    // 1 / depth at which plane i cuts the ray from this camera along own_from + phi (own_to -
    // own_from)
    Fraction u(std::size_t i, const Fraction& phi) const {
        const Big normal = cross(big(from[i]), big(to[i]));
        Big ray;
        for (std::size_t c = 0; c < 3; ++c)
            ray[c] = Fraction(own_from[c]) + phi * Fraction(own_to[c] - own_from[c]);
        return -dot(normal, ray) / dot(normal, big(offset[i]));
    }
};

class ExactPredicates : public testing::Test {
protected:
    Random random_{12345};
};

TEST_F(ExactPredicates, FindTheSideOfARay) {
    for (int i = 0; i < 2000; ++i) {
        const Vector a = random_vector(random_, kBaseline);
        const Vector b = random_vector(random_, kRay);
        const Vector c = random_vector(random_, kRay);
        EXPECT_EQ(sign_of_determinant(a, b, c), sign(dot(big(a), cross(big(b), big(c)))));
        EXPECT_EQ(sign_of_determinant(a, b, b), 0);
    }
}

TEST_F(ExactPredicates, OrderLinesAlongARay) {
    for (int i = 0; i < 1000; ++i) {
        const Setting s(random_);
        const Vector baseline = random_vector(random_, kBaseline);
        const Place place = place_of(random_vector(random_, kRay), baseline, s.own_from, s.own_to);
        if (place.w_from + place.w_to == 0) continue;
        const auto fraction = [](Int128 v) { return Fraction(boost::multiprecision::cpp_int(v)); };
        const Fraction phi = fraction(place.w_to) / (fraction(place.w_from) + fraction(place.w_to));
        const Fraction u0 = s.u(0, phi);
        const Fraction u1 = s.u(1, phi);
        EXPECT_EQ(compare_u(s.lines[0], s.lines[1], place), sign(Fraction(u0 - u1)));
        EXPECT_EQ(compare_u(s.lines[0], s.lines[0], place), 0);
        EXPECT_EQ(compare_u(s.lines[0], kInfinity, place), sign(u0));
        if (u0 != 0) {
            const double expected = u0.convert_to<double>();
            EXPECT_NEAR(u_of(s.lines[0], place), expected, 1e-14 * std::abs(expected));
        }
    }
}

TEST_F(ExactPredicates, PlaceRaysAlongTheStrip) {
    for (int i = 0; i < 1000; ++i) {
        const Setting s(random_);
        // a ray in the plane of the baseline, and a ray of the strip with a known parameter
        const Vector baseline = random_vector(random_, kBaseline >> 12);
        const auto place = [&](int share) {
            Vector ray;
            for (std::size_t c = 0; c < 3; ++c) {
                ray[c] = (s.own_from[c] >> 10) * (8 - share) + (s.own_to[c] >> 10) * share +
                         (baseline[c] >> 6);
            }
            Vector from;
            Vector to;
            for (std::size_t c = 0; c < 3; ++c) {
                from[c] = s.own_from[c] >> 10;
                to[c] = s.own_to[c] >> 10;
            }
            Vector along_baseline = baseline;
            for (std::size_t c = 0; c < 3; ++c) along_baseline[c] = baseline[c] >> 6;
            return place_of(ray, along_baseline, from, to);
        };
        const Place near = place(2);
        const Place middle = place(4);
        if (near.w_from == 0 && near.w_to == 0) continue;
        EXPECT_LT(compare_phi(near, middle), 0);
        EXPECT_GT(compare_phi(middle, near), 0);
        EXPECT_EQ(compare_phi(middle, Place{1, 1}), 0);
        EXPECT_EQ(compare_phi(near, Place{3, 1}), 0);
    }
}

TEST_F(ExactPredicates, OrderSlopesAndCrossings) {
    int num_crossings = 0;
    for (int i = 0; i < 1000; ++i) {
        const Setting s(random_);
        const auto slope = [&](std::size_t j) { return Fraction(s.u(j, 1) - s.u(j, 0)); };
        EXPECT_EQ(compare_slope(s.lines[0], s.lines[1]), sign(Fraction(slope(0) - slope(1))));
        const auto crossing = [&](std::size_t j, std::size_t k, Fraction& phi) {
            const Fraction at_from = s.u(j, 0) - s.u(k, 0);
            const Fraction at_to = s.u(j, 1) - s.u(k, 1);
            if (at_from == at_to) return false;
            phi = at_from / (at_from - at_to);
            return phi > 0 && phi < 1;
        };
        Fraction left;
        Fraction right;
        if (!crossing(0, 1, left)) continue;
        const Point point = crossing_of(s.lines[0], s.lines[1]);
        const double phi = left.convert_to<double>();
        const double u = s.u(0, left).convert_to<double>();
        EXPECT_NEAR(point.phi, phi, 1e-14 * phi);
        EXPECT_NEAR(point.u, u, 1e-14 * std::abs(u));
        if (!crossing(2, 3, right)) continue;
        ++num_crossings;
        EXPECT_EQ(compare_crossings(s.lines[0], s.lines[1], s.lines[2], s.lines[3]),
                  sign(Fraction(left - right)));
        EXPECT_EQ(compare_crossings(s.lines[0], s.lines[1], s.lines[1], s.lines[0]), 0);
    }
    EXPECT_GT(num_crossings, 50);
}

}  // namespace
}  // namespace atrium::hull::exact
