#include "core/base/thread_pool.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "tests/unit/hull/hull_of_a_sphere.hpp"

#include <gtest/gtest.h>

namespace atrium::hull {
namespace {

TEST_F(HullOfASphere, HasTheSameBitsForAnyNumberOfWorkers) {
    ThreadPool pool(4);
    VisualHull parallel;
    const VisualHull serial = compute_visual_hull(views_, {}, scratch_);
    for (int round = 0; round < 20; ++round) {
        compute_visual_hull(views_, {}, scratch_, pool, parallel);
        ASSERT_EQ(serial.mesh.vertices, parallel.mesh.vertices);
        ASSERT_EQ(serial.mesh.triangles, parallel.mesh.triangles);
    }
}

}  // namespace
}  // namespace atrium::hull
