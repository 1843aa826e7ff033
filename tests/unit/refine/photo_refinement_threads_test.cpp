#include "core/base/thread_pool.hpp"
#include "site_node/refine/photo_refinement.hpp"
#include "tests/unit/refine/dish_scene.hpp"

#include <gtest/gtest.h>

namespace atrium::refine {
namespace {

// Two metaframes, of which the second knows the first, and one that knows none, in used memory.
TEST(PhotoRefinement, IsTheSameForAnyNumberOfThreadsAndWithUsedMemory) {
    const DishScene first = film_dish({.depth_m = 0.03}, 7);
    const DishScene second = film_dish({}, 6);
    const auto refined =
        [&](const DishScene& scene, PhotoRefinement& refinement, Executor& executor) {
            geometry::TriangleMesh mesh = scene.hull;
            EXPECT_TRUE(refinement.refine(mesh, scene.views(), executor));
            return mesh;
        };
    SerialExecutor serial;
    PhotoRefinement alone;
    const geometry::TriangleMesh expected_first = refined(first, alone, serial);
    const geometry::TriangleMesh expected_second = refined(second, alone, serial);
    ThreadPool pool(3);
    PhotoRefinement refinement;
    for (int round = 0; round < 2; ++round) {
        const geometry::TriangleMesh mesh = refined(first, refinement, pool);
        EXPECT_EQ(mesh.vertices, expected_first.vertices);
        EXPECT_EQ(mesh.triangles, expected_first.triangles);
        const geometry::TriangleMesh next = refined(second, refinement, pool);
        EXPECT_EQ(next.vertices, expected_second.vertices);
        EXPECT_EQ(next.triangles, expected_second.triangles);
        refinement.forget();
    }
}

}  // namespace
}  // namespace atrium::refine
