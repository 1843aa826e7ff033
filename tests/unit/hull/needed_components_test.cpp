#include "core/base/thread_pool.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/support/shapes/winding_number.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace atrium::hull {
namespace {

using test::Sphere;

const Sphere kLeft{{-0.6, 0.1, 0.9}, 0.2};
const Sphere kRight{{0.6, -0.1, 0.9}, 0.2};

// Level cameras: two bodies at one height then meet in many places.
std::vector<geometry::CalibratedCamera> level_rig(int num_cameras) {
    return test::make_ring_rig(
        {.num_cameras = num_cameras, .heights_m = {0.9}, .first_angle_rad = 0.2});
}

std::vector<SilhouetteView> views_of_spheres(std::span<const Sphere> spheres,
                                             std::span<const geometry::CalibratedCamera> rig) {
    std::vector<SilhouetteView> views;
    for (const auto& camera : rig) {
        std::vector<test::Contour> contours;
        for (const Sphere& sphere : spheres)
            contours.push_back(test::outline_of(sphere, camera, 24));
        views.push_back(test::make_view(camera, contours));
    }
    return views;
}

HullOptions keeping_all() {
    HullOptions options;
    options.keep_phantoms = true;
    return options;
}

bool holds(const VisualHull& hull, const Sphere& sphere) {
    return test::winding_number(hull.mesh, sphere.centre_site) > 0.5;
}

TEST(NeededComponents, DropsWhereNobodyStands) {
    const Sphere both[] = {kLeft, kRight};
    const auto views = views_of_spheres(both, level_rig(3));
    HullScratch scratch;
    const VisualHull all = compute_visual_hull(views, keeping_all(), scratch);
    const VisualHull hull = compute_visual_hull(views, {}, scratch);
    EXPECT_GT(all.num_components, 2u);
    EXPECT_EQ(hull.num_components, 2u);
    EXPECT_EQ(hull.num_phantoms_dropped + hull.num_fragments_dropped, all.num_components - 2u);
    EXPECT_NEAR(geometry::volume_m3(hull.mesh) + hull.volume_dropped_m3,
                geometry::volume_m3(all.mesh),
                1e-12);
    EXPECT_TRUE(holds(hull, kLeft));
    EXPECT_TRUE(holds(hull, kRight));
    EXPECT_TRUE(geometry::inspect(hull.mesh).manifold);
}

TEST(NeededComponents, KeepsAllThatTwoCamerasCannotTellApart) {
    const Sphere both[] = {kLeft, kRight};
    const auto rig = level_rig(5);
    const auto views = views_of_spheres(both, std::span(rig).first(2));
    HullScratch scratch;
    EXPECT_EQ(compute_visual_hull(views, {}, scratch).num_components, 4u);
}

TEST(NeededComponents, KeepsASmallBodyThatOnlyOneCameraSees) {
    // two cameras have a body before the ball
    const auto rig = level_rig(3);
    const Sphere ball{{0.0, 0.0, 0.9}, 0.05};
    std::vector<Sphere> bodies;
    for (const std::size_t camera : {0u, 1u})
        bodies.push_back({0.7 * ball.centre_site + 0.3 * rig[camera].centre_site(), 0.2});
    auto views = views_of_spheres(bodies, rig);
    bodies.push_back(ball);
    views[2].contours.push_back(test::outline_of(ball, rig[2], 24));
    HullScratch scratch;
    const VisualHull hull = compute_visual_hull(views, {}, scratch);
    for (const Sphere& body : bodies) EXPECT_TRUE(holds(hull, body)) << body.centre_site;
}

TEST(NeededComponents, AreChosenInPartialViewsToo) {
    const Sphere both[] = {kLeft, kRight};
    auto views = views_of_spheres(both, level_rig(3));
    for (SilhouetteView& view : views) view.field = {{1, 1}, {1, 998}, {998, 998}, {998, 1}};
    HullOptions options;
    options.bounds = geometry::Aabb{{-1.0, -0.5, 0.5}, {1.0, 0.5, 1.3}};
    HullScratch scratch;
    const VisualHull hull = compute_visual_hull(views, options, scratch);
    EXPECT_EQ(hull.num_components, 2u);
    EXPECT_GT(hull.num_phantoms_dropped, 0u);
    EXPECT_TRUE(holds(hull, kLeft));
    EXPECT_TRUE(holds(hull, kRight));
}

TEST(NeededComponents, AreTheSameForAnyOrderAndNumberOfWorkers) {
    const Sphere both[] = {kLeft, kRight};
    auto views = views_of_spheres(both, level_rig(3));
    HullScratch scratch;
    const VisualHull serial = compute_visual_hull(views, {}, scratch);
    std::reverse(views.begin(), views.end());
    ThreadPool pool(3);
    VisualHull parallel;
    compute_visual_hull(std::span<const SilhouetteView>(views), {}, scratch, pool, parallel);
    EXPECT_EQ(serial.num_components, 2u);
    EXPECT_GT(serial.num_phantoms_dropped, 0u);
    EXPECT_EQ(parallel.num_phantoms_dropped, serial.num_phantoms_dropped);
    EXPECT_EQ(parallel.mesh.vertices, serial.mesh.vertices);
    EXPECT_EQ(parallel.mesh.triangles, serial.mesh.triangles);
}

}  // namespace
}  // namespace atrium::hull
