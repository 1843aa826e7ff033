#include "site_node/silhouette/silhouette.hpp"

#include "tests/support/allocation_counter.hpp"
#include "tests/unit/silhouette/test_masks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::silhouette {
namespace {

geometry::PinholeCamera straight_camera(int width, int height) {
    return {.width = width,
            .height = height,
            .fx = 800.0,
            .fy = 800.0,
            .cx = 0.5 * width,
            .cy = 0.5 * height};
}

// Bends straight lines at the border of a picture of 1000 x 1000 px by about ten pixels.
geometry::PinholeCamera wide_camera() {
    geometry::PinholeCamera camera = straight_camera(1000, 1000);
    camera.distortion = {-0.28, 0.08, 0.0005, -0.0003, 0.0};
    return camera;
}

double area_px(const std::vector<SilhouettePolygon>& polygons) {
    double sum = 0.0;
    for (const SilhouettePolygon& polygon : polygons) sum += signed_area_px(polygon);
    return sum;
}

std::size_t num_vertices(const std::vector<SilhouettePolygon>& polygons) {
    std::size_t n = 0;
    for (const SilhouettePolygon& polygon : polygons) n += polygon.vertices_px.size();
    return n;
}

double distance_px(const Eigen::Vector2d& p, const std::vector<SilhouettePolygon>& polygons) {
    double best = 1e30;
    for (const SilhouettePolygon& polygon : polygons) {
        for (std::size_t k = 0; k < polygon.vertices_px.size(); ++k) {
            const Eigen::Vector2d& a = polygon.vertices_px[k];
            const Eigen::Vector2d along =
                polygon.vertices_px[(k + 1) % polygon.vertices_px.size()] - a;
            const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
            best = std::min(best, (p - a - t * along).norm());
        }
    }
    return best;
}

bool all_simple(const std::vector<SilhouettePolygon>& polygons) {
    EdgeGrid grid;
    std::vector<EdgeConflict> conflicts;
    find_conflicts(polygons, grid, conflicts);
    return conflicts.empty();
}

struct Result {
    std::vector<SilhouettePolygon> polygons;
    SilhouetteCounts counts;
};

Result extract(const image::Mask& mask,
               const geometry::PinholeCamera& camera,
               const SilhouetteOptions& options = {}) {
    SilhouetteScratch scratch;
    Result result;
    result.counts = extract_silhouette(mask, camera, options, scratch, result.polygons);
    return result;
}

TEST(Silhouette, PersonIsOneBlobAndOneHoleWithTheRightOrientation) {
    const Result result = extract(test::person_mask(), straight_camera(1000, 1000));
    ASSERT_EQ(result.polygons.size(), 2u);
    EXPECT_FALSE(result.polygons[0].is_hole);
    EXPECT_GT(signed_area_px(result.polygons[0]), 0.0);
    EXPECT_TRUE(result.polygons[1].is_hole);
    EXPECT_LT(signed_area_px(result.polygons[1]), 0.0);
    EXPECT_FALSE(result.counts.touches_border);
    SilhouetteOptions one_pixel;
    one_pixel.tolerance_px = 1.0;
    const Result coarse = extract(test::person_mask(), straight_camera(1000, 1000), one_pixel);
    EXPECT_LT(num_vertices(coarse.polygons), 200u);
}

TEST(Silhouette, EnclosesTheAreaOfTheMaskWithoutBias) {
    std::mt19937 random(3);
    for (const double roughness : {0.0, 0.2}) {
        image::Mask mask = test::person_mask();
        test::roughen(mask, roughness, random);
        for (const double tolerance_px : {0.5, 1.0, 2.0}) {
            const Result result =
                extract(mask, straight_camera(1000, 1000), {.tolerance_px = tolerance_px});
            const auto truth = static_cast<double>(test::num_foreground(mask));
            EXPECT_NEAR(area_px(result.polygons) / truth, 1.0, 0.002)
                << tolerance_px << " px, roughness " << roughness;
        }
    }
}

TEST(Silhouette, DiscKeepsItsAreaAtEverySizeAndPosition) {
    for (const double radius : {12.0, 30.3, 77.7, 160.0}) {
        for (int i = 0; i < 4; ++i) {
            image::Mask mask(400, 400);
            test::draw(mask,
                       {200 + 0.27 * i, 200 - 0.19 * i, 200 + 0.27 * i, 200 - 0.19 * i, radius});
            const Result result = extract(mask, straight_camera(400, 400));
            const auto truth = static_cast<double>(test::num_foreground(mask));
            // at most a tenth of a pixel of the radius
            EXPECT_NEAR(area_px(result.polygons), truth, 0.1 * 2.0 * 3.14159 * radius) << radius;
        }
    }
}

TEST(Silhouette, KeepsEveryContourPointWithinTheTolerance) {
    std::mt19937 random(11);
    image::Mask mask(500, 500);
    test::draw(mask, {120, 120, 380, 300, 40});
    test::draw(mask, {380, 120, 150, 400, 25});
    test::roughen(mask, 0.25, random);
    ContourSet contours;
    trace_contours(mask, 100, contours);
    for (const double tolerance_px : {0.5, 1.0, 2.0}) {
        const Result result =
            extract(mask, straight_camera(500, 500), {.tolerance_px = tolerance_px});
        for (const GridPoint p : contours.points) {
            EXPECT_LE(distance_px({0.5 * p.x, 0.5 * p.y}, result.polygons), tolerance_px + 1e-6);
        }
    }
}

TEST(Silhouette, PolygonsAreSimpleEvenWithNoiseAndThinBridges) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        const Result noise = extract(test::noise_mask(120, 120, 0.5 + 0.02 * seed, seed),
                                     straight_camera(120, 120),
                                     {.tolerance_px = 2.0, .min_area_px = 1});
        EXPECT_TRUE(all_simple(noise.polygons)) << seed;
        EXPECT_EQ(noise.counts.num_not_simple, 0u);
    }
    // lines and gaps, each one pixel wide
    image::Mask comb(200, 100);
    for (int x = 10; x < 190; x += 2)
        test::draw(comb, {1.0 * x, 10, 1.0 * x + 0.2 * (x % 7), 80, 0.6});
    test::draw(comb, {10, 82, 190, 84, 3});
    const Result result =
        extract(comb, straight_camera(200, 100), {.tolerance_px = 2.0, .min_area_px = 4});
    EXPECT_TRUE(all_simple(result.polygons));
    EXPECT_EQ(result.counts.num_not_simple, 0u);
}

TEST(Silhouette, NoisyDistortedMasksStaySimple) {
    for (unsigned seed = 0; seed < 4; ++seed) {
        const Result result = extract(test::noise_mask(1000, 120, 0.6, seed),
                                      wide_camera(),
                                      {.tolerance_px = 1.0, .min_area_px = 1});
        EXPECT_TRUE(all_simple(result.polygons)) << seed;
        EXPECT_EQ(result.counts.num_not_simple, 0u);
    }
}

TEST(Silhouette, MovesWithTheMask) {
    image::Mask first(300, 300);
    image::Mask second(300, 300);
    test::draw(first, {80, 80, 150, 200, 30});
    test::draw(second, {97, 91, 167, 211, 30});
    const Result a = extract(first, straight_camera(300, 300));
    const Result b = extract(second, straight_camera(300, 300));
    ASSERT_EQ(num_vertices(a.polygons), num_vertices(b.polygons));
    for (std::size_t k = 0; k < a.polygons[0].vertices_px.size(); ++k) {
        const Eigen::Vector2d moved = a.polygons[0].vertices_px[k] + Eigen::Vector2d(17, 11);
        EXPECT_LT((moved - b.polygons[0].vertices_px[k]).norm(), 1e-9);
    }
}

TEST(Silhouette, ClosesAlongThePictureBorderAndReportsIt) {
    image::Mask mask(100, 80);
    for (int y = 30; y < 80; ++y) std::fill_n(mask.row(y) + 20, 40, 255);
    const Result result = extract(mask, straight_camera(100, 80));
    EXPECT_TRUE(result.counts.touches_border);
    ASSERT_EQ(result.polygons.size(), 1u);
    EXPECT_NEAR(area_px(result.polygons), 40 * 50, 1.0);
    double lowest = 0.0;
    for (const Eigen::Vector2d& p : result.polygons[0].vertices_px)
        lowest = std::max(lowest, p.y());
    EXPECT_NEAR(lowest, 79.5, 0.1);
}

TEST(Silhouette, UndistortedPolygonFollowsTheUndistortedContour) {
    image::Mask mask(1000, 1000);
    for (int y = 30; y < 970; ++y)
        std::fill_n(mask.row(y) + 25, 940, 255);  // long straight edges near the border
    test::draw(mask, {400, 500, 600, 520, 100}, 0);
    const geometry::PinholeCamera camera = wide_camera();
    const Result result = extract(mask, camera);
    ASSERT_EQ(result.polygons.size(), 2u);
    ContourSet contours;
    trace_contours(mask, 100, contours);
    double scale = 1.0;  // undistortion stretches the tolerance
    for (const GridPoint p : contours.points) {
        const Eigen::Vector2d px(0.5 * p.x, 0.5 * p.y);
        const Eigen::Vector2d here = camera.undistort(px).value();
        scale =
            std::max(scale, (camera.undistort(px + Eigen::Vector2d(1, 0)).value() - here).norm());
        scale =
            std::max(scale, (camera.undistort(px + Eigen::Vector2d(0, 1)).value() - here).norm());
        EXPECT_LE(distance_px(here, result.polygons), 1.0 * scale + 0.15);
    }
    // straight edges of the mask have no noise: only the bend of the lens counts
    for (int x = 100; x < 900; x += 7) {
        EXPECT_LE(distance_px(camera.undistort({x, 29.5}).value(), result.polygons), 0.12);
        EXPECT_LE(distance_px(camera.undistort({x, 969.5}).value(), result.polygons), 0.12);
    }
}

TEST(Silhouette, OmitsContoursWithoutUndistortionAndTheirInside) {
    geometry::PinholeCamera fish = straight_camera(1000, 1000);
    fish.distortion = {-0.9, 0.0, 0.0, 0.0, 0.0};  // folds over long before the corners
    ASSERT_FALSE(fish.undistort({30, 30}).has_value());
    ASSERT_TRUE(fish.undistort({500, 620}).has_value());
    image::Mask mask(1000, 1000, 255);               // blob: the whole picture
    test::draw(mask, {500, 500, 500, 500, 120}, 0);  // its hole, which could be undistorted
    test::draw(mask, {500, 500, 500, 500, 60});      // and a blob in that hole
    const Result all = extract(mask, fish);
    EXPECT_TRUE(all.polygons.empty());
    EXPECT_EQ(all.counts.num_not_undistorted, 3u);

    image::Mask two(1000, 1000);
    test::draw(two, {500, 500, 500, 500, 60});
    test::draw(two, {30, 30, 30, 30, 20});
    const Result one = extract(two, fish);
    EXPECT_EQ(one.polygons.size(), 1u);
    EXPECT_EQ(one.counts.num_not_undistorted, 1u);
    EXPECT_FALSE(one.counts.touches_border);
}

TEST(Silhouette, EmptyMaskGivesNoPolygons) {
    const Result result = extract(image::Mask(64, 48), straight_camera(64, 48));
    EXPECT_TRUE(result.polygons.empty());
    EXPECT_EQ(result.counts.num_small, 0u);
}

TEST(Silhouette, WarmScratchGivesTheSameResultAndDoesNotAllocate) {
    std::mt19937 random(5);
    image::Mask mask = test::person_mask();
    test::roughen(mask, 0.2, random);
    const geometry::PinholeCamera camera = wide_camera();
    SilhouetteScratch scratch;
    std::vector<SilhouettePolygon> out;
    extract_silhouette(mask, camera, {}, scratch, out);
    const std::vector<SilhouettePolygon> first = out;
    const std::uint64_t before = atrium::test::num_allocations();
    extract_silhouette(mask, camera, {}, scratch, out);
    EXPECT_EQ(atrium::test::num_allocations(), before);
    ASSERT_EQ(first.size(), out.size());
    for (std::size_t p = 0; p < out.size(); ++p)
        EXPECT_EQ(first[p].vertices_px, out[p].vertices_px);
}

}  // namespace
}  // namespace atrium::silhouette
