#include "core/geometry/pinhole_camera.hpp"

#include <gtest/gtest.h>

#include <random>

namespace atrium::geometry {
namespace {

PinholeCamera lens() {
    PinholeCamera camera{640, 480, 490.0, 492.0, 330.0, 228.0};
    camera.skew = -1.3;
    camera.distortion = {-0.368, 0.194, -0.0002, 0.0003, -0.061};
    return camera;
}

TEST(PinholeCamera, RayInvertsProjection) {
    const PinholeCamera camera = lens();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-100, 740);
    for (int i = 0; i < 500; ++i) {
        const Eigen::Vector2d p(u(random), u(random));
        EXPECT_LT((camera.project(camera.ray_camera(p) * 2.7) - p).norm(), 1e-9);
    }
}

TEST(PinholeCamera, UndistortInvertsDistortInsideThePicture) {
    const PinholeCamera camera = lens();
    for (double y = -0.5; y < 480; y += 37) {
        for (double x = -0.5; x < 640; x += 31) {
            const auto undistorted = camera.undistort({x, y});
            ASSERT_TRUE(undistorted.has_value()) << x << ", " << y;
            EXPECT_LT((camera.distort(*undistorted) - Eigen::Vector2d(x, y)).norm(), 1e-7);
        }
    }
}

// OpenCV documents its model with these formulas (calib3d, "Detailed Description").
TEST(PinholeCamera, DistortsByTheModelThatOpenCvDocuments) {
    PinholeCamera camera = lens();
    camera.skew = 0.0;
    const Eigen::Vector2d p = camera.distort(camera.project({0.5, -0.35, 1.0}));
    const double r2 = 0.5 * 0.5 + 0.35 * 0.35;
    const double radial = 1 - 0.368 * r2 + 0.194 * r2 * r2 - 0.061 * r2 * r2 * r2;
    const double x = 0.5 * radial + 2 * -0.0002 * 0.5 * -0.35 + 0.0003 * (r2 + 2 * 0.25);
    const double y = -0.35 * radial - 0.0002 * (r2 + 2 * 0.1225) + 2 * 0.0003 * 0.5 * -0.35;
    EXPECT_NEAR(p.x(), 490.0 * x + 330.0, 1e-9);
    EXPECT_NEAR(p.y(), 492.0 * y + 228.0, 1e-9);
}

TEST(PinholeCamera, RefusesPixelsBeyondTheFoldOfTheLensModel) {
    PinholeCamera camera{640, 480, 500.0, 500.0, 320.0, 240.0};
    camera.distortion = {-0.3, 0.0, 0.0, 0.0, 0.0};  // r (1 - 0.3 r^2) never exceeds 0.703
    EXPECT_TRUE(camera.undistort({320 + 500 * 0.69, 240}).has_value());
    EXPECT_FALSE(camera.undistort({320 + 500 * 0.72, 240}).has_value());
}

}  // namespace
}  // namespace atrium::geometry
