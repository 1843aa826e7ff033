#include "core/base/thread_pool.hpp"
#include "site_node/refine/photo_refinement.hpp"
#include "tests/unit/refine/dish_scene.hpp"

#include <gtest/gtest.h>

namespace atrium::refine {
namespace {

TEST(PhotoRefinement, IsTheSameForAnyNumberOfThreadsAndWithUsedMemory) {
    const DishScene scene = film_dish({}, 6);
    const DishScene other = film_dish({.depth_m = 0.03}, 7);
    SerialExecutor serial;
    geometry::TriangleMesh expected = scene.hull;
    ASSERT_TRUE(PhotoRefinement().refine(expected, scene.views(), serial));
    ThreadPool pool(3);
    PhotoRefinement refinement;
    geometry::TriangleMesh mesh = other.hull;
    ASSERT_TRUE(refinement.refine(mesh, other.views(), pool));
    mesh = scene.hull;
    ASSERT_TRUE(refinement.refine(mesh, scene.views(), pool));
    EXPECT_EQ(mesh.vertices, expected.vertices);
    EXPECT_EQ(mesh.triangles, expected.triangles);
}

}  // namespace
}  // namespace atrium::refine
