#include "site_node/hull/better_diagonals.hpp"

#include "tests/support/allocation_counter.hpp"
#include "tests/support/random.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace atrium::hull {
namespace {

using Points = std::vector<Eigen::Vector2d>;
using Triangle = std::array<std::uint32_t, 3>;
using Triangles = std::vector<Triangle>;
using test::between;
using test::Random;
using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;

double twice_area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

std::map<DirectedEdge, int> edges_of(const Triangles& triangles) {
    std::map<DirectedEdge, int> edges;
    for (const auto& [a, b, c] : triangles) {
        ++edges[{a, b}];
        ++edges[{b, c}];
        ++edges[{c, a}];
    }
    return edges;
}

// Directed edges minus their opposites: the boundary, which no triangulation changes.
std::map<DirectedEdge, int> boundary_of(const Triangles& triangles) {
    std::map<DirectedEdge, int> boundary = edges_of(triangles);
    for (auto& [edge, count] : boundary) {
        const auto opposite = boundary.find({edge.second, edge.first});
        if (opposite == boundary.end()) continue;
        const int both = std::min(count, opposite->second);
        count -= both;
        opposite->second -= both;
    }
    std::erase_if(boundary, [](const auto& entry) { return entry.second == 0; });
    return boundary;
}

int most_triangles_at_an_edge(const Triangles& triangles) {
    const auto edges = edges_of(triangles);
    int most = 0;
    for (const auto& [edge, count] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        most = std::max(most, count + (opposite == edges.end() ? 0 : opposite->second));
    }
    return most;
}

double area_of(const Points& points, const Triangles& triangles) {
    double sum = 0.0;
    for (const auto& [a, b, c] : triangles)
        sum += 0.5 * twice_area(points[a], points[b], points[c]);
    return sum;
}

double smallest_angle(const Points& points, const Triangles& triangles) {
    double smallest = std::numbers::pi;
    for (const auto& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector2d u = points[t[(k + 1) % 3]] - points[t[k]];
            const Eigen::Vector2d v = points[t[(k + 2) % 3]] - points[t[k]];
            smallest =
                std::min(smallest, std::atan2(std::abs(u.x() * v.y() - u.y() * v.x()), u.dot(v)));
        }
    }
    return smallest;
}

// How far `d` is inside the circle through a, b, c (counter-clockwise), relative to its radius.
double depth_in_circle(const Eigen::Vector2d& a,
                       const Eigen::Vector2d& b,
                       const Eigen::Vector2d& c,
                       const Eigen::Vector2d& d) {
    Eigen::Matrix2d edges;
    edges.row(0) = (b - a).transpose();
    edges.row(1) = (c - a).transpose();
    const Eigen::Vector2d half_squares(0.5 * (b - a).squaredNorm(), 0.5 * (c - a).squaredNorm());
    const double determinant = edges.determinant();
    const Eigen::Vector2d centre(
        a.x() + (half_squares[0] * edges(1, 1) - half_squares[1] * edges(0, 1)) / determinant,
        a.y() + (half_squares[1] * edges(0, 0) - half_squares[0] * edges(1, 0)) / determinant);
    const double radius = (a - centre).norm();
    return 1.0 - (d - centre).norm() / radius;
}

// Triangulates by ear clipping. `loop` may visit a vertex twice, for example at a bridge to a hole.
Triangles clip_ears(const Points& points, std::vector<std::uint32_t> loop) {
    Triangles triangles;
    while (loop.size() > 3) {
        bool found = false;
        for (std::size_t i = 0; i < loop.size() && !found; ++i) {
            const std::uint32_t a = loop[(i + loop.size() - 1) % loop.size()];
            const std::uint32_t b = loop[i];
            const std::uint32_t c = loop[(i + 1) % loop.size()];
            if (twice_area(points[a], points[b], points[c]) <= 0.0) continue;
            found = std::none_of(loop.begin(), loop.end(), [&](std::uint32_t v) {
                return v != a && v != b && v != c &&
                       twice_area(points[a], points[b], points[v]) >= 0.0 &&
                       twice_area(points[b], points[c], points[v]) >= 0.0 &&
                       twice_area(points[c], points[a], points[v]) >= 0.0;
            });
            if (!found) continue;
            triangles.push_back({a, b, c});
            loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
        }
        if (!found) return {};
    }
    triangles.push_back({loop[0], loop[1], loop[2]});
    return triangles;
}

struct Face {
    Points points;
    Triangles triangles;
};

// A star-shaped polygon with `num_corners`, with a star-shaped hole unless `num_hole` is 0.
Face random_face(Random& random, std::size_t num_corners, std::size_t num_hole) {
    Face face;
    const auto add_star = [&](std::size_t n, double low, double high) {
        for (std::size_t i = 0; i < n; ++i) {
            const double angle = 2.0 * std::numbers::pi *
                                 (static_cast<double>(i) + between(random, 0.05, 0.95)) /
                                 static_cast<double>(n);
            face.points.push_back(between(random, low, high) *
                                  Eigen::Vector2d(std::cos(angle), std::sin(angle)));
        }
    };
    add_star(num_corners, 0.6, 1.0);
    add_star(num_hole, 0.05, 0.2);
    std::vector<std::uint32_t> loop;
    for (std::uint32_t i = 0; i < num_corners; ++i) loop.push_back(i);
    if (num_hole > 0) {
        // from the outer corner with the smallest angle to the nearest corner of the hole,
        // clockwise around it, and back
        std::uint32_t nearest = static_cast<std::uint32_t>(num_corners);
        for (auto i = nearest; i < face.points.size(); ++i) {
            if ((face.points[i] - face.points[0]).norm() <
                (face.points[nearest] - face.points[0]).norm())
                nearest = i;
        }
        loop.push_back(0);
        const auto n = static_cast<std::uint32_t>(num_hole);
        const std::uint32_t first = nearest - static_cast<std::uint32_t>(num_corners);
        for (std::uint32_t i = 0; i <= n; ++i) {
            loop.push_back(static_cast<std::uint32_t>(num_corners) + (first + n - i % n) % n);
        }
    }
    face.triangles = clip_ears(face.points, loop);
    return face;
}

TEST(BetterDiagonals, ExchangesTheLongDiagonalOfAFlatQuad) {
    const Points points{{0.0, 0.0}, {1.0, -0.1}, {2.0, 0.0}, {1.0, 0.1}};
    Triangles triangles{{0, 1, 2}, {0, 2, 3}};
    BetterDiagonals diagonals;
    diagonals.improve(points, triangles);
    const auto edges = edges_of(triangles);
    EXPECT_EQ(edges.count({1, 3}) + edges.count({3, 1}), 2u);
    EXPECT_EQ(edges.count({0, 2}), 0u);
    EXPECT_NEAR(area_of(points, triangles), 0.2, 1e-15);
}

TEST(BetterDiagonals, DoesTheSameFromBehind) {
    const Points points{{0.0, 0.0}, {1.0, -0.1}, {2.0, 0.0}, {1.0, 0.1}};
    Triangles triangles{{0, 2, 1}, {0, 3, 2}};
    BetterDiagonals diagonals;
    diagonals.improve(points, triangles);
    EXPECT_EQ(edges_of(triangles).count({1, 3}), 1u);
    EXPECT_NEAR(area_of(points, triangles), -0.2, 1e-15);
}

TEST(BetterDiagonals, KeepsNotchesSquaresAndJoinedCorners) {
    BetterDiagonals diagonals;
    // the quad is concave at 1: the other diagonal would lie outside
    const Points dart{{0.0, 0.0}, {1.0, 0.1}, {2.0, 0.0}, {1.0, 1.0}};
    const Triangles dart_before{{0, 1, 3}, {1, 2, 3}};
    Triangles triangles = dart_before;
    diagonals.improve(dart, triangles);
    EXPECT_EQ(triangles, dart_before);
    // neither diagonal is better
    const Points square{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
    const Triangles square_before{{0, 1, 2}, {0, 2, 3}};
    triangles = square_before;
    diagonals.improve(square, triangles);
    EXPECT_EQ(triangles, square_before);
    // another triangle, on the other side of the face's plane, already joins 1 and 3
    const Points flat{{0.0, 0.0}, {1.0, -0.1}, {2.0, 0.0}, {1.0, 0.1}, {1.05, 0.0}};
    const Triangles flat_before{{0, 1, 2}, {0, 2, 3}, {1, 3, 4}};
    triangles = flat_before;
    diagonals.improve(flat, triangles);
    EXPECT_EQ(triangles, flat_before);
}

TEST(BetterDiagonals, NeverJoinsCollinearCorners) {
    const Points points{{0.0, 0.0}, {1.0, -0.1}, {2.0, 0.0}, {1.0, 0.1}};
    const Triangles before{{0, 1, 2}, {0, 2, 3}};
    const std::vector<BetterDiagonals::Lines> apart{{1, 2}, {2, 3}, {3, 4}, {4, 1}};
    const std::vector<BetterDiagonals::Lines> on_line_3{{1, 2}, {2, 3}, {5, 4}, {3, 1}};
    BetterDiagonals diagonals;
    Triangles triangles = before;
    diagonals.improve(points, triangles, on_line_3);
    EXPECT_EQ(triangles, before);
    diagonals.improve(points, triangles, apart);
    EXPECT_NE(triangles, before);
}

TEST(BetterDiagonals, SplitsTheSideUnderADegenerateTriangle) {
    // 3 lies on the edge from 0 to 1
    const Points points{{0.0, 0.0}, {2.0, 0.0}, {1.0, -1.0}, {1.0, 0.0}};
    Triangles triangles{{0, 1, 3}, {1, 0, 2}};
    const auto boundary = boundary_of(triangles);
    BetterDiagonals diagonals;
    diagonals.improve(points, triangles);
    EXPECT_EQ(boundary_of(triangles), boundary);
    for (const auto& [a, b, c] : triangles)
        EXPECT_GT(twice_area(points[a], points[b], points[c]), 0.9);
}

class RandomFace : public testing::TestWithParam<int> {};

TEST_P(RandomFace, KeepsItsBoundaryAndLosesItsSmallestAngles) {
    Random random(static_cast<std::uint64_t>(GetParam()));
    BetterDiagonals diagonals;
    int num_improved = 0;
    for (int round = 0; round < 20; ++round) {
        const auto num_corners = static_cast<std::size_t>(3 + random() % 60);
        const std::size_t num_hole = round % 2 == 0 ? 0 : 3 + random() % 20;
        Face face = random_face(random, num_corners, num_hole);
        if (face.triangles.empty()) continue;  // the bridge crosses an edge
        const Triangles before = face.triangles;
        diagonals.improve(face.points, face.triangles);
        EXPECT_EQ(boundary_of(face.triangles), boundary_of(before));
        EXPECT_LE(most_triangles_at_an_edge(face.triangles), 2);
        EXPECT_NEAR(area_of(face.points, face.triangles), area_of(face.points, before), 1e-12);
        for (const auto& [a, b, c] : face.triangles)
            EXPECT_GT(twice_area(face.points[a], face.points[b], face.points[c]), 0.0);
        const double old_angle = smallest_angle(face.points, before);
        EXPECT_GE(smallest_angle(face.points, face.triangles), old_angle * (1.0 - 1e-9));
        num_improved += face.triangles != before ? 1 : 0;
        Triangles again = face.triangles;
        diagonals.improve(face.points, again);
        EXPECT_EQ(again, face.triangles);
    }
    EXPECT_GT(num_improved, 5);
}

TEST_P(RandomFace, IsDelaunayAcrossEveryDiagonalOfAConvexSet) {
    Random random(static_cast<std::uint64_t>(GetParam()));
    const auto n = static_cast<std::uint32_t>(4 + random() % 60);
    std::vector<double> angles;
    for (std::uint32_t i = 0; i < n; ++i)
        angles.push_back(between(random, 0.0, 2.0 * std::numbers::pi));
    std::sort(angles.begin(), angles.end());
    Points points;  // on an ellipse
    for (const double angle : angles) points.emplace_back(3.0 * std::cos(angle), std::sin(angle));
    Triangles triangles;
    for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
    BetterDiagonals diagonals;
    diagonals.improve(points, triangles);
    // The set is convex, so only its outline constrains the triangles. No corner may lie inside any
    // circumcircle.
    for (const auto& [a, b, c] : triangles) {
        for (const Eigen::Vector2d& p : points)
            EXPECT_LT(depth_in_circle(points[a], points[b], points[c], p), 1e-6);
    }
}

TEST_P(RandomFace, KeepsItsCombinatoricsForHostileNumbers) {
    Random random(static_cast<std::uint64_t>(GetParam()));
    BetterDiagonals diagonals;
    for (int round = 0; round < 40; ++round) {
        Face face = random_face(random, 3 + random() % 30, round % 3 == 0 ? 5 : 0);
        if (face.triangles.empty()) continue;
        const double huge[] = {1e300, 1e-300, 0.0, 1e160, 1.0};
        for (Eigen::Vector2d& p : face.points) {
            switch (round % 5) {
                case 0:
                    p.y() = 0.0;
                    break;  // collinear
                case 1:
                    p = {std::round(2.0 * p.x()), std::round(2.0 * p.y())};
                    break;  // twice
                case 2:
                    p.y() *= 1e-15;
                    break;
                case 3:
                    p *= huge[random() % 5];
                    break;
                default:
                    p = {between(random, -1, 1), between(random, -1, 1)};  // flipped
            }
        }
        const Triangles before = face.triangles;
        diagonals.improve(face.points, face.triangles);
        EXPECT_EQ(face.triangles.size(), before.size());
        EXPECT_EQ(boundary_of(face.triangles), boundary_of(before));
        EXPECT_LE(most_triangles_at_an_edge(face.triangles), 2);
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomFace, testing::Range(0, 12));

TEST(BetterDiagonals, KeepsDegenerateTriangles) {
    const Points points{{0.0, 0.0}, {1.0, -0.1}, {2.0, 0.0}, {1.0, 0.1}};
    BetterDiagonals diagonals;
    for (const Triangles& before : {Triangles{{0, 1, 2}, {0, 2, 9}},
                                    Triangles{{0, 1, 1}, {0, 2, 3}},
                                    Triangles{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}},
                                    Triangles{{0, 1, 2}, {0, 2, 1}}}) {
        Triangles triangles = before;
        diagonals.improve(points, triangles);
        EXPECT_EQ(triangles, before);
    }
}

TEST(BetterDiagonals, DoesNotAllocateOnceWarm) {
    Random random(5);
    std::vector<Face> faces;
    for (int i = 0; i < 20; ++i) faces.push_back(random_face(random, 3 + random() % 40, 0));
    BetterDiagonals diagonals;
    for (const Face& face : faces) {
        Triangles triangles = face.triangles;
        diagonals.improve(face.points, triangles);
    }
    const std::uint64_t before = test::num_allocations();
    for (Face& face : faces) diagonals.improve(face.points, face.triangles);
    EXPECT_EQ(test::num_allocations(), before);
}

}  // namespace
}  // namespace atrium::hull
