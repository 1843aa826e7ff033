#include "core/config/rig.hpp"
#include "core/geometry/decimate.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/views/views_file.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/support/shapes/surface_distance.hpp"
#include "tests/support/shapes/winding_number.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

// Compares decimated hulls with the original hulls, by measurements on both meshes only.
namespace atrium {
namespace {

using geometry::DecimateReport;
using geometry::TriangleMesh;

TriangleMesh hull_of(const std::vector<hull::SilhouetteView>& views) {
    hull::HullScratch scratch;
    hull::VisualHull hull = hull::compute_visual_hull(views, {}, scratch);
    if (hull.status != hull::HullStatus::kOk) hull.mesh.clear();
    return hull.mesh;
}

// A point farther from both surfaces than they are from each other is inside both or outside both.
// Otherwise the surface was flipped or torn.
void expect_same_inside(const TriangleMesh& in, const TriangleMesh& out, double bound_m) {
    const geometry::Aabb box = geometry::bounds(in);
    const test::SurfaceDistance to_in(in);
    std::mt19937_64 random(5);
    int num_inside = 0;
    for (int i = 0; i < 200; ++i) {
        Eigen::Vector3d p;
        for (int c = 0; c < 3; ++c)
            p[c] = std::uniform_real_distribution<double>(box.min[c], box.max[c])(random);
        if (to_in.distance_m(p) <= bound_m) continue;
        const double before = test::winding_number(in, p);
        EXPECT_NEAR(test::winding_number(out, p), before, 1e-6) << p.transpose();
        num_inside += before > 0.5 ? 1 : 0;
    }
    EXPECT_GT(num_inside, 0);
}

std::size_t expect_sound(const TriangleMesh& in, double max_m, int num_samples) {
    geometry::DecimateScratch scratch;
    TriangleMesh out;
    const auto report = geometry::decimate(in, {.max_distance_m = max_m}, scratch, out);
    EXPECT_TRUE(report);
    if (!report) return in.triangles.size();
    const geometry::MeshReport before = geometry::inspect(in);
    const geometry::MeshReport after = geometry::inspect(out);
    EXPECT_TRUE(after.closed);
    EXPECT_TRUE(after.manifold);
    EXPECT_EQ(after.num_components, before.num_components);
    EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
    EXPECT_LE(report->distance_bound_m, max_m);
    EXPECT_LE(test::SurfaceDistance(out).largest_m(in, num_samples), report->distance_bound_m);
    EXPECT_LE(test::SurfaceDistance(in).largest_m(out, num_samples), report->distance_bound_m);
    expect_same_inside(in, out, report->distance_bound_m);
    return out.triangles.size();
}

class DecimatedHull : public testing::TestWithParam<int> {};

TEST_P(DecimatedHull, StaysWithinItsBoundForRandomOutlines) {
    std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
    std::vector<hull::SilhouetteView> views;
    for (const auto& camera :
         test::make_ring_rig({.num_cameras = 4 + GetParam() % 4, .target_site = {0.0, 0.0, 0.0}})) {
        const Eigen::Vector2d middle(499.5, 499.5);
        std::vector<test::Contour> contours{test::random_star(random, middle, 200.0, 25)};
        if (GetParam() % 2 == 0)
            contours.push_back(test::random_star(random, middle, 50.0, 6));  // a hole
        views.push_back(test::make_view(camera, contours));
    }
    const TriangleMesh in = hull_of(views);
    ASSERT_FALSE(in.empty());
    for (const double max_m : {1e-3, 10e-3, 50e-3}) expect_sound(in, max_m, 2000);
}

TEST_P(DecimatedHull, OfASphereLosesTrianglesAndKeepsItsOutside) {
    const test::Sphere sphere{{0.02 * GetParam(), 0.0, 0.9}, 0.4};
    const auto rig = test::make_ring_rig({.num_cameras = 5 + GetParam() % 3});
    const TriangleMesh in = hull_of(test::views_of(sphere, rig, 100));
    ASSERT_FALSE(in.empty());
    EXPECT_LT(expect_sound(in, 5e-3, 3000), in.triangles.size() / 3);
    geometry::DecimateScratch scratch;
    TriangleMesh out;
    ASSERT_TRUE(geometry::decimate(in, {.max_distance_m = 5e-3}, scratch, out));
    for (const auto& [a, b, c] : out.triangles) {
        const auto& p = out.vertices;
        const Eigen::Vector3d normal = (p[b] - p[a]).cross(p[c] - p[a]);
        EXPECT_GT(normal.dot((p[a] + p[b] + p[c]) / 3.0 - sphere.centre_site), 0.0);
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, DecimatedHull, testing::Range(0, 10));

TEST(DecimatedPerson, StaysWithinItsBound) {
    auto rig = config::load_rig(atrium::test::source_dir() + "/deploy/rigs/full_body.toml");
    ASSERT_TRUE(rig) << rig.error().message;
    simulation::RoomOptions options;
    options.look = "ben";
    options.motion = "wave";
    auto renderer = simulation::RoomRenderer::create(rig->cameras, options);
    ASSERT_TRUE(renderer) << renderer.error().message;
    std::vector<hull::SilhouetteView> views;
    silhouette::SilhouetteScratch scratch;
    for (std::size_t c = 0; c < rig->cameras.size(); ++c) {
        image::YuvImage picture;
        image::Mask mask;
        renderer->render(0.4, c, simulation::Scene::kPerson, 0, picture, &mask);
        const geometry::CalibratedCamera& camera = rig->cameras[c];
        std::vector<silhouette::SilhouettePolygon> polygons;
        silhouette::extract_silhouette(mask, camera.intrinsics, {}, scratch, polygons);
        hull::SilhouetteView view{camera.intrinsics, camera.camera_from_site, {}, {}};
        for (auto& polygon : polygons) view.contours.push_back(std::move(polygon.vertices_px));
        views.push_back(std::move(view));
    }
    const TriangleMesh in = hull_of(views);
    ASSERT_FALSE(in.empty());
    expect_sound(in, 2e-3, 5000);
    EXPECT_LT(expect_sound(in, 10e-3, 5000), in.triangles.size() / 3);
}

TEST(DecimatedPerson, OfTheSetHasASixthOfItsTrianglesAt5Mm) {
    const std::filesystem::path file =
        atrium::test::source_dir() + "/../shared/data/hulls/person_10k.json";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << atrium::test::skip::kNoSharedData << file;
    const auto loaded = views::load_views_file(file);
    ASSERT_TRUE(loaded) << loaded.error().message;
    std::vector<hull::SilhouetteView> views;
    for (const auto& view : *loaded) views.push_back(view.view);
    const TriangleMesh in = hull_of(views);
    ASSERT_GT(in.triangles.size(), 10'000u);
    expect_sound(in, 1e-3, 10'000);
    EXPECT_LT(expect_sound(in, 5e-3, 10'000), in.triangles.size() / 6);
}

}  // namespace
}  // namespace atrium
