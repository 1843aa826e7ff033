#include "viewer/renderer/person/warm_up_person.hpp"

#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/outline_strip.hpp"

#include <gtest/gtest.h>

namespace atrium::renderer {
namespace {

// Otherwise the driver would compile some shader only when the first person is drawn.
TEST(WarmUpPerson, UsesEachPersonShaderOnce) {
    const Eigen::Vector3f target(0.2f, -0.1f, 1.0f);
    for (const Eigen::Vector3f& eye : {Eigen::Vector3f(3, -3, 1.7f),
                                       Eigen::Vector3f(0.2f, -0.1f, 4),
                                       Eigen::Vector3f(-2, 0.3f, 0.1f)}) {
        for (const std::size_t num_cameras : {6U, 8U, 255U}) {
            const PersonModel person = make_warm_up_person(eye, target, num_cameras);
            EXPECT_EQ(person.cameras.size(), num_cameras);
            BlendScratch scratch;
            BlendedMesh blended;
            blend_for_view(person, eye, scratch, blended);
            for (std::size_t g = 0; g < blended.groups.size(); ++g)
                EXPECT_EQ(blended.groups[g].triangles.size(), 1U)
                    << "of " << kCamerasPerTriangle[g] << " cameras, from " << eye.transpose();
            OutlineStrip strip;
            strip.find(person, eye, scratch);
            EXPECT_EQ(strip.num_vertices(), 6U);
        }
    }
}

}  // namespace
}  // namespace atrium::renderer
