#include "tests/support/shapes/solid_error.hpp"

#include "tests/support/shapes/closed_meshes.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace atrium::test {
namespace {

double ball_l(double radius_m) {
    return 1e3 * 4.0 / 3.0 * std::numbers::pi * radius_m * radius_m * radius_m;
}

void move(geometry::TriangleMesh& mesh, const Eigen::Vector3d& by) {
    for (auto& vertex : mesh.vertices) vertex += by;
}

TEST(SolidError, OfALargerBallIsTheShellAroundTheSmallOne) {
    const auto truth = make_sphere(5, 0.3);
    const auto mesh = make_sphere(5, 0.33);
    const SolidError error = compare_solids(truth, mesh);
    EXPECT_NEAR(error.true_volume_l, ball_l(0.3), 0.3);
    EXPECT_NEAR(error.volume_l, ball_l(0.33), 0.4);
    EXPECT_NEAR(error.excess_l, ball_l(0.33) - ball_l(0.3), 1.0);
    EXPECT_EQ(error.missing_l, 0.0);
    for (const double distance :
         {error.mean_mm, error.p95_mm, error.true_mean_mm, error.true_p95_mm})
        EXPECT_NEAR(distance, 30.0, 0.5);
}

TEST(SolidError, OfALimbThatIsMissingIsItsVolume) {
    auto truth = make_sphere(4, 0.3);
    auto limb = make_sphere(4, 0.1);
    move(limb, {0.6, 0.0, 0.0});
    const auto mesh = truth;
    geometry::append(truth, limb);
    const SolidError error = compare_solids(truth, mesh);
    EXPECT_EQ(error.excess_l, 0.0);
    EXPECT_NEAR(error.missing_l, ball_l(0.1), 0.3);
    EXPECT_NEAR(error.mean_mm, 0.0, 1e-6);
    // a tenth of the true surface is the limb's, 200 to 400 mm away
    EXPECT_NEAR(error.true_mean_mm, 30.0, 5.0);
    EXPECT_GT(error.true_p95_mm, 200.0);
    const SolidError swapped = compare_solids(mesh, truth);
    EXPECT_EQ(swapped.missing_l, 0.0);
    EXPECT_NEAR(swapped.excess_l, ball_l(0.1), 0.3);
    EXPECT_GT(swapped.p95_mm, 200.0);
}

}  // namespace
}  // namespace atrium::test
