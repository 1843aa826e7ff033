// Properties of silhouette polygons, also for masks that no camera delivers. Integers decide
// whatever they can: vertices lie on a grid of 1/1024 px.

#include "site_node/silhouette/silhouette.hpp"
#include "tests/support/random.hpp"
#include "tests/unit/silhouette/test_masks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace atrium::silhouette {
namespace {

using atrium::test::between;
using atrium::test::Random;

__extension__ typedef __int128 Int128;

constexpr int kUnits = 1024;  // per pixel
const std::vector<double> kTolerances_px{0.25, 0.5, 0.75, 1.0, 1.3, 2.0, 5.0};

struct Scene {
    std::string name;
    image::Mask mask;
};

// ---------------------------------------------------------------- masks

image::Mask random_blobs(Random& random) {
    std::mt19937 rough(static_cast<unsigned>(random()));
    image::Mask mask(between(random, 40, 120), between(random, 40, 120));
    const int num = between(random, 1, 6);
    for (int i = 0; i < 2 * num; ++i) {
        // some extend beyond the border; every second one cuts a hole
        const double x = between(random, -10.0, mask.width + 10.0);
        const double y = between(random, -10.0, mask.height + 10.0);
        test::draw(mask,
                   {x,
                    y,
                    x + between(random, -40.0, 40.0),
                    y + between(random, -40.0, 40.0),
                    between(random, 0.6, i % 2 == 0 ? 18.0 : 6.0)},
                   i % 2 == 0 ? 255 : 0);
    }
    test::roughen(mask, between(random, 0.0, 0.4), rough);
    return mask;
}

// Threads and gaps of one or two pixels, at any slope.
image::Mask random_threads(Random& random) {
    image::Mask mask(80, 80, between(random, 0, 1) == 0 ? 0 : 255);
    const std::uint8_t value = mask.data[0] == 0 ? 255 : 0;
    for (int i = 0; i < 14; ++i) {
        test::draw(mask,
                   {between(random, 0.0, 80.0),
                    between(random, 0.0, 80.0),
                    between(random, 0.0, 80.0),
                    between(random, 0.0, 80.0),
                    between(random, 0.5, 1.1)},
                   value);
    }
    return mask;
}

// Arms of one pixel with gaps of one pixel, wound up.
image::Mask spiral(int size) {
    image::Mask mask(size, size);
    int x = 0;
    int y = 0;
    int length = size - 1;
    int dx = 1;
    int dy = 0;
    for (int turn = 0; length > 0; ++turn) {
        for (int i = 0; i < length; ++i, x += dx, y += dy) mask.row(y)[x] = 255;
        std::swap(dx, dy);
        dx = -dx;
        if (turn >= 2 && turn % 2 == 0) length -= 2;
    }
    return mask;
}

std::vector<Scene> special_masks() {
    std::vector<Scene> scenes{{"empty", image::Mask(20, 20)},
                              {"full", image::Mask(33, 17, 255)},
                              {"one pixel", image::Mask(5, 5)},
                              {"one row", image::Mask(60, 1, 255)},
                              {"one column", image::Mask(1, 60, 255)},
                              {"checkerboard", image::Mask(24, 24)},
                              {"comb", image::Mask(80, 40)},
                              {"spiral", spiral(41)},
                              {"frame", image::Mask(40, 40, 255)}};
    scenes[2].mask.row(2)[3] = 255;
    for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 24; ++x) scenes[5].mask.row(y)[x] = (x + y) % 2 == 0 ? 255 : 0;
    }
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 80; ++x)
            scenes[6].mask.row(y)[x] = x % 2 == 0 || y == 39 || (y == 20 && x > 40) ? 255 : 0;
    }
    for (int y = 1; y < 39; ++y) std::fill_n(scenes[8].mask.row(y) + 1, 38, 0);
    return scenes;
}

std::vector<Scene> all_masks(unsigned num_seeds) {
    std::vector<Scene> scenes = special_masks();
    for (unsigned seed = 0; seed < num_seeds; ++seed) {
        Random random(seed);
        const std::string suffix = " " + std::to_string(seed);
        scenes.push_back({"blobs" + suffix, random_blobs(random)});
        scenes.push_back({"threads" + suffix, random_threads(random)});
        scenes.push_back(
            {"noise" + suffix,
             test::noise_mask(40 + static_cast<int>(seed), 37, 0.3 + 0.02 * (seed % 30), seed)});
    }
    return scenes;
}

// ---------------------------------------------------------------- exact geometry

struct Point {
    std::int64_t x;
    std::int64_t y;
};

Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
std::int64_t cross(Point a, Point b) { return a.x * b.y - a.y * b.x; }
std::int64_t dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
int sign(std::int64_t v) { return v > 0 ? 1 : (v < 0 ? -1 : 0); }

Point units(const Eigen::Vector2d& px) {
    const Point p{std::llround(px.x() * kUnits), std::llround(px.y() * kUnits)};
    EXPECT_EQ(static_cast<double>(p.x), px.x() * kUnits) << "not on the grid";
    EXPECT_EQ(static_cast<double>(p.y), px.y() * kUnits) << "not on the grid";
    return p;
}

Point units(GridPoint p) { return {p.x * (kUnits / 2), p.y * (kUnits / 2)}; }

std::vector<Point> units(const std::vector<Eigen::Vector2d>& polygon_px) {
    std::vector<Point> points;
    for (const Eigen::Vector2d& p : polygon_px) points.push_back(units(p));
    return points;
}

// Whether the distance from p to the line segment a b is at most `limit` units.
bool is_near(Point p, Point a, Point b, std::int64_t limit) {
    const Point ab = b - a;
    const Point ap = p - a;
    const Point bp = p - b;
    if (dot(ab, ap) <= 0) return dot(ap, ap) <= limit * limit;
    if (dot(ab, bp) >= 0) return dot(bp, bp) <= limit * limit;
    const Int128 doubled_area = cross(ab, ap);
    return doubled_area * doubled_area <= static_cast<Int128>(limit * limit) * dot(ab, ab);
}

bool have_common_point(Point a, Point b, Point c, Point d) {
    if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
        std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y))
        return false;
    return sign(cross(b - a, c - a)) * sign(cross(b - a, d - a)) <= 0 &&
           sign(cross(d - c, a - c)) * sign(cross(d - c, b - c)) <= 0;
}

std::int64_t doubled_area(const std::vector<Point>& polygon) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        sum += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
    return sum;
}

// No two edges of any polygons have a common point, except the vertex between neighbours.
bool are_simple_and_apart(const std::vector<std::vector<Point>>& polygons) {
    struct Edge {
        Point a;
        Point b;
        std::size_t polygon;
        std::size_t index;
    };
    std::vector<Edge> edges;
    for (std::size_t p = 0; p < polygons.size(); ++p) {
        for (std::size_t i = 0; i < polygons[p].size(); ++i)
            edges.push_back({polygons[p][i], polygons[p][(i + 1) % polygons[p].size()], p, i});
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
        for (std::size_t k = i + 1; k < edges.size(); ++k) {
            const Edge& s = edges[i];
            const Edge& t = edges[k];
            const bool same = s.polygon == t.polygon;
            const bool t_follows = same && s.index + 1 == t.index;
            const bool s_follows =
                same && s.index == 0 && t.index + 1 == polygons[s.polygon].size();
            if (!t_follows && !s_follows) {
                if (have_common_point(s.a, s.b, t.a, t.b)) return false;
                continue;
            }
            const Edge& first = t_follows ? s : t;
            const Edge& second = t_follows ? t : s;
            if (cross(first.b - first.a, second.b - second.a) == 0 &&
                dot(first.b - first.a, second.b - second.a) <= 0)
                return false;
        }
    }
    return true;
}

// ---------------------------------------------------------------- properties

struct Result {
    SilhouetteScratch scratch;
    std::vector<SilhouettePolygon> polygons;
    SilhouetteCounts counts;
};

void extract(const image::Mask& mask, double tolerance_px, Result& out) {
    const geometry::PinholeCamera camera{
        .width = mask.width, .height = mask.height, .fx = 100.0, .fy = 100.0};
    out.counts = extract_silhouette(
        mask, camera, {.tolerance_px = tolerance_px, .min_area_px = 1}, out.scratch, out.polygons);
}

// Checks one contour against its polygon `k`.
void expect_bound(const Result& result, std::size_t c, double tolerance_px) {
    const auto contour = result.scratch.contours.points_of(result.scratch.contours.contours[c]);
    const Outline& outline = result.scratch.outlines[c];
    const std::int64_t limit = static_cast<std::int64_t>(tolerance_px * 64.0) * (kUnits / 64);
    const std::size_t n = outline.segments.size();
    ASSERT_GE(n, 3u);
    ASSERT_EQ(outline.vertices_px.size(), n);
    ASSERT_EQ(outline.segments[0].begin, 0u) << "the start is not fixed";
    for (std::size_t k = 0; k < n; ++k) {
        const Point a = units(outline.vertices_px[k]);
        const Point b = units(outline.vertices_px[(k + 1) % n]);
        const std::size_t end = k + 1 < n ? outline.segments[k + 1].begin : contour.size();
        ASSERT_LT(outline.segments[k].begin, end);
        for (std::size_t i = outline.segments[k].begin; i <= end; ++i)
            ASSERT_TRUE(is_near(units(contour[i % contour.size()]), a, b, limit)) << "point " << i;
        const Point moved = a - units(contour[outline.segments[k].begin]);
        ASSERT_LE(dot(moved, moved), 4 * limit * limit) << "vertex far from its contour point";
    }
}

void expect_sound(const Scene& scene, double tolerance_px) {
    SCOPED_TRACE(scene.name + ", tolerance " + std::to_string(tolerance_px));
    Result result;
    extract(scene.mask, tolerance_px, result);
    ASSERT_EQ(result.counts.num_not_simple, 0u);
    ASSERT_EQ(result.polygons.size(), result.scratch.contours.contours.size());
    std::vector<std::vector<Point>> polygons;
    for (std::size_t c = 0; c < result.polygons.size(); ++c) {
        expect_bound(result, c, tolerance_px);
        if (testing::Test::HasFatalFailure()) return;
        ASSERT_EQ(result.polygons[c].vertices_px, result.scratch.outlines[c].vertices_px);
        polygons.push_back(units(result.polygons[c].vertices_px));
        ASSERT_EQ(result.polygons[c].is_hole, result.scratch.contours.contours[c].area_px < 0);
        ASSERT_EQ(sign(doubled_area(polygons.back())), result.polygons[c].is_hole ? -1 : 1);
    }
    ASSERT_TRUE(are_simple_and_apart(polygons));
}

TEST(SilhouetteProperty, EveryContourPointIsWithinToleranceOfItsOwnEdge) {
    for (const Scene& scene : all_masks(40)) {
        for (const double tolerance_px : kTolerances_px) {
            expect_sound(scene, tolerance_px);
            if (HasFatalFailure()) return;
        }
    }
}

TEST(SilhouetteProperty, PersonsKeepTheBoundAndAreSimple) {
    for (unsigned seed = 0; seed < 3; ++seed) {
        std::mt19937 random(seed);
        Scene scene{"person", test::person_mask()};
        test::roughen(scene.mask, 0.15 * seed, random);
        for (const double tolerance_px : {0.75, 2.0}) {
            expect_sound(scene, tolerance_px);
            if (HasFatalFailure()) return;
        }
    }
}

// A larger picture with the mask somewhere inside.
image::Mask placed(const image::Mask& mask, int x0, int y0, int width, int height) {
    image::Mask out(width, height);
    for (int y = 0; y < mask.height; ++y)
        std::copy_n(mask.row(y), mask.width, out.row(y + y0) + x0);
    return out;
}

TEST(SilhouetteProperty, PolygonsMoveWithTheMaskBitForBit) {
    for (const Scene& scene : all_masks(25)) {
        SCOPED_TRACE(scene.name);
        Random random(scene.mask.data.size());
        const double tolerance_px = kTolerances_px[static_cast<std::size_t>(between(random, 0, 6))];
        const Eigen::Vector2i from(between(random, 0, 60), between(random, 0, 60));
        const Eigen::Vector2i to(between(random, 0, 900), between(random, 0, 700));
        Result here;
        Result there;
        extract(placed(scene.mask, from.x(), from.y(), 181, 190), tolerance_px, here);
        extract(placed(scene.mask, to.x(), to.y(), 1100, 900), tolerance_px, there);
        ASSERT_EQ(here.polygons.size(), there.polygons.size());
        for (std::size_t p = 0; p < here.polygons.size(); ++p) {
            ASSERT_EQ(here.polygons[p].vertices_px.size(), there.polygons[p].vertices_px.size());
            for (std::size_t k = 0; k < here.polygons[p].vertices_px.size(); ++k) {
                const Eigen::Vector2d moved =
                    here.polygons[p].vertices_px[k] + (to - from).cast<double>();
                ASSERT_EQ(moved, there.polygons[p].vertices_px[k]) << p << ", " << k;
            }
        }
    }
}

// The start is stable: the corner at the leftmost crack of the topmost row (for a hole, the
// rightmost crack of the lowest row). Segments before a change stay the same.
TEST(SilhouetteProperty, SegmentsBeforeAChangeStay) {
    int num_compared = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
        Random random(seed);
        image::Mask mask = random_blobs(random);
        ContourSet before;
        trace_contours(mask, 30, before);
        if (before.contours.empty()) continue;
        const auto contour = before.points_of(before.contours[0]);
        for (const GridPoint p : contour) {
            ASSERT_TRUE(contour[0].y < p.y || (contour[0].y == p.y && contour[0].x <= p.x));
        }
        // removes a foreground pixel at three quarters of the contour
        const GridPoint crack = contour[contour.size() * 3 / 4];
        const auto pixel = [](int half) { return static_cast<int>(std::floor(0.5 * half + 0.25)); };
        int x = pixel(crack.x);
        int y = pixel(crack.y);
        if (mask.at(std::clamp(x, 0, mask.width - 1), std::clamp(y, 0, mask.height - 1)) == 0)
            (crack.x % 2 != 0 ? x : y) += 1;
        if (x < 0 || y < 0 || x >= mask.width || y >= mask.height || mask.at(x, y) == 0) continue;
        mask.row(y)[x] = 0;
        ContourSet after;
        trace_contours(mask, 30, after);
        if (after.contours.empty()) continue;
        const auto changed = after.points_of(after.contours[0]);
        std::size_t same = 0;
        while (same < std::min(contour.size(), changed.size()) && contour[same] == changed[same])
            ++same;
        BlurredSegment segment;
        segment.set_thickness_px(1.0);
        std::vector<std::uint32_t> breaks;
        std::vector<std::uint32_t> changed_breaks;
        split_into_blurred_segments(contour, 0, contour.size(), segment, breaks);
        split_into_blurred_segments(changed, 0, changed.size(), segment, changed_breaks);
        for (std::size_t k = 0; k < breaks.size() && breaks[k] + 1 < same; ++k) {
            ASSERT_LT(k, changed_breaks.size());
            ASSERT_EQ(breaks[k], changed_breaks[k]) << "seed " << seed;
            ++num_compared;
        }
    }
    EXPECT_GT(num_compared, 300);
}

}  // namespace
}  // namespace atrium::silhouette
