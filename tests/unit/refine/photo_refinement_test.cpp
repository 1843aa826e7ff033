#include "site_node/refine/photo_refinement.hpp"

#include "core/base/executor.hpp"
#include "tests/unit/refine/dish_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace atrium::refine {
namespace {

struct Error {
    double mean_mm = 0.0;
    double largest_mm = 0.0;
    std::size_t num = 0;
};

// Distances of the vertices over the hollow to its surface. Close to the rim, the block's top and
// the hollow are the same for cameras.
Error error_over_hollow(const geometry::TriangleMesh& mesh, const Dish& dish) {
    Error error;
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        if (vertex.head<2>().norm() > 0.75 * dish.rim_radius_m) continue;
        if (vertex.z() < 0.3 * dish.height_m) continue;
        const double off_mm = 1e3 * std::abs(dish.distance_m(vertex));
        error.mean_mm += off_mm;
        error.largest_mm = std::max(error.largest_mm, off_mm);
        ++error.num;
    }
    error.mean_mm /= static_cast<double>(std::max<std::size_t>(error.num, 1));
    return error;
}

TEST(PhotoRefinement, FindsTheHollowThatNoSilhouetteShows) {
    const Dish dish;
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const DishScene scene = film_dish(dish, seed);
        geometry::TriangleMesh refined = scene.hull;
        SerialExecutor executor;
        PhotoRefinement refinement;
        ASSERT_TRUE(refinement.refine(refined, scene.views(), executor));
        const geometry::MeshReport before = geometry::inspect(scene.hull);
        const geometry::MeshReport after = geometry::inspect(refined);
        EXPECT_TRUE(after.manifold);
        EXPECT_EQ(after.num_components, before.num_components);
        EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
        EXPECT_LT(after.volume_m3, before.volume_m3);
        const Error hull_error = error_over_hollow(scene.hull, dish);
        const Error error = error_over_hollow(refined, dish);
        ASSERT_GT(error.num, 50U);
        RecordProperty("mean_mm", std::to_string(error.mean_mm));
        EXPECT_LT(error.mean_mm, 10.0) << "of the hull " << hull_error.mean_mm;
    }
}

TEST(PhotoRefinement, KeepsTheSilhouettes) {
    const DishScene scene = film_dish({}, 4);
    geometry::TriangleMesh refined = scene.hull;
    SerialExecutor executor;
    ASSERT_TRUE(PhotoRefinement().refine(refined, scene.views(), executor));
    // extents of the block, which outlines show
    const geometry::Aabb before = geometry::bounds(scene.hull);
    const geometry::Aabb after = geometry::bounds(refined);
    EXPECT_LT((before.max - after.max).cwiseAbs().maxCoeff(), 0.006);
    EXPECT_LT((before.min - after.min).cwiseAbs().maxCoeff(), 0.006);
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const geometry::CalibratedCamera& camera = scene.cameras[i];
        for (const Eigen::Vector3d& vertex : refined.vertices) {
            const Eigen::Vector3d at =
                camera.camera_from_site.rotation * vertex + camera.camera_from_site.translation;
            const Eigen::Vector2d px = camera.intrinsics.project(at);
            bool is_near_mask = false;  // outlines are polygons: within 2 px
            for (int y = -2; y <= 2; ++y) {
                for (int x = -2; x <= 2; ++x)
                    is_near_mask |= scene.masks[i].at(static_cast<int>(px.x() + 0.5) + x,
                                                      static_cast<int>(px.y() + 0.5) + y) != 0;
            }
            ASSERT_TRUE(is_near_mask) << camera.name << " " << vertex.transpose();
        }
    }
}

TEST(PhotoRefinement, MovesNothingThatHasNoContrast) {
    const DishScene scene = film_dish({}, 5, 0.0);
    geometry::TriangleMesh refined = scene.hull;
    SerialExecutor executor;
    PhotoRefinement refinement;
    ASSERT_TRUE(refinement.refine(refined, scene.views(), executor));
    EXPECT_EQ(refinement.sweep().counts().num_accepted, 0U);
    EXPECT_EQ(refined.vertices, scene.hull.vertices);
    EXPECT_EQ(refined.triangles, scene.hull.triangles);
}

TEST(PhotoRefinement, ChangesNothingWithoutTwoPicturesOrForOpenMeshes) {
    const DishScene scene = film_dish({}, 8);
    SerialExecutor executor;
    PhotoRefinement refinement;
    std::vector<PictureView> views = scene.views();
    geometry::TriangleMesh mesh = scene.hull;
    EXPECT_FALSE(refinement.refine(mesh, {}, executor));
    for (std::size_t i = 1; i < views.size(); ++i) views[i].picture = {};
    EXPECT_FALSE(refinement.refine(mesh, views, executor));
    EXPECT_EQ(mesh.vertices, scene.hull.vertices);
    mesh.triangles.pop_back();
    EXPECT_FALSE(refinement.refine(mesh, scene.views(), executor));
    EXPECT_EQ(mesh.vertices, scene.hull.vertices);
    mesh.clear();
    EXPECT_FALSE(refinement.refine(mesh, scene.views(), executor));
}

TEST(PhotoRefinement, WorksWhileSomeCamerasHaveNoPicture) {
    const Dish dish;
    const DishScene scene = film_dish(dish, 9);
    std::vector<PictureView> views = scene.views();
    views[1].picture = {};
    views[1].mask = nullptr;
    SerialExecutor executor;
    geometry::TriangleMesh mesh = scene.hull;
    ASSERT_TRUE(PhotoRefinement().refine(mesh, views, executor));
    EXPECT_TRUE(geometry::inspect(mesh).manifold);
    EXPECT_LT(error_over_hollow(mesh, dish).mean_mm,
              0.5 * error_over_hollow(scene.hull, dish).mean_mm);
}

}  // namespace
}  // namespace atrium::refine
