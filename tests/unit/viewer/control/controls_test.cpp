#include "viewer/control/controls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace atrium::viewer {
namespace {

const renderer::ViewCamera kStartView{.position_m = {3.0, -2.0, 1.5}, .target_m = {0.0, 0.5, 1.0}};

double distance(const renderer::ViewCamera& camera) {
    return (camera.position_m - camera.target_m).norm();
}

TEST(Controls, DoNothingWithoutMotion) {
    const auto camera = apply({}, kStartView);
    EXPECT_LT((camera.position_m - kStartView.position_m).norm(), 1e-12);
    EXPECT_EQ(camera.target_m, kStartView.target_m);
}

TEST(Controls, OrbitKeepsTargetAndDistance) {
    const auto camera = apply({.turn_px = {120.0, -35.0}}, kStartView);
    EXPECT_EQ(camera.target_m, kStartView.target_m);
    EXPECT_NEAR(distance(camera), distance(kStartView), 1e-12);
    EXPECT_GT((camera.position_m - kStartView.position_m).norm(), 0.5);
}

TEST(Controls, DraggingDownRaisesTheOrbitingEye) {
    EXPECT_GT(apply({.turn_px = {0.0, 20.0}}, kStartView).position_m.z(),
              kStartView.position_m.z());
}

TEST(Controls, WalkingStaysOnTheFloor) {
    renderer::ViewCamera camera = kStartView;
    const Eigen::Vector2d ahead =
        (camera.target_m - camera.position_m).head<2>().normalized().eval();
    for (int i = 0; i < 60; ++i)
        camera = apply({.fly = {0, 1, 1}, .seconds = 1.0 / 60.0, .walk = true}, camera);
    EXPECT_NEAR(camera.position_m.z(), 1.65, 1e-9);
    const Eigen::Vector2d way = (camera.position_m - kStartView.position_m).head<2>();
    EXPECT_NEAR(way.norm(), 1.4, 1e-6) << "the tilt of the eye must not change the walking speed";
    EXPECT_NEAR(way.normalized().dot(ahead), 1.0, 1e-9);
    const auto turned = apply({.turn_px = {80.0, 20.0}, .walk = true}, camera);
    EXPECT_EQ(turned.position_m, camera.position_m) << "the mouse must only turn the head";
    EXPECT_GT((turned.target_m - camera.target_m).norm(), 0.3);
}

TEST(Controls, LookingAroundKeepsTheEye) {
    const auto camera = apply({.turn_px = {80.0, 20.0}, .look_around = true}, kStartView);
    EXPECT_EQ(camera.position_m, kStartView.position_m);
    EXPECT_NEAR(distance(camera), distance(kStartView), 1e-12);
    EXPECT_GT((camera.target_m - kStartView.target_m).norm(), 0.5);
}

TEST(Controls, ZoomMovesAlongTheViewUpToALimit) {
    const auto nearer = apply({.zoom_steps = 3.0}, kStartView);
    EXPECT_LT(distance(nearer), distance(kStartView));
    const Eigen::Vector3d before = (kStartView.position_m - kStartView.target_m).normalized();
    EXPECT_LT(((nearer.position_m - nearer.target_m).normalized() - before).norm(), 1e-12);
    EXPECT_GE(distance(apply({.zoom_steps = 1000.0}, kStartView)), 0.19);
    EXPECT_LE(distance(apply({.zoom_steps = -1000.0}, kStartView)), 51.0);
}

TEST(Controls, FlyingForwardMovesTheTargetToo) {
    const auto camera = apply({.fly = {0.0, 1.0, 0.0}, .seconds = 0.5}, kStartView);
    const Eigen::Vector3d way = camera.position_m - kStartView.position_m;
    EXPECT_LT((way - (camera.target_m - kStartView.target_m)).norm(), 1e-12);
    EXPECT_GT(way.dot((kStartView.target_m - kStartView.position_m).normalized()), 0.5);
}

TEST(Controls, OrbitAndZoomKeepTheEyeAboveTheFloor) {
    renderer::ViewCamera camera = kStartView;
    for (int i = 0; i < 100; ++i) {
        camera = apply({.turn_px = {3.0, -20.0}, .zoom_steps = i < 50 ? 0.0 : -1.0}, camera);
        ASSERT_GE(camera.position_m.z(), 0.049) << i;
    }
    EXPECT_EQ(camera.target_m, kStartView.target_m);
    EXPECT_NEAR(distance(camera), 50.0, 1e-6) << "zooming must still work";
    const auto raised = apply({.turn_px = {0.0, 20.0}}, camera);
    EXPECT_GT(raised.position_m.z(), camera.position_m.z() + 1.0) << "the way back is open";
    // whoever flew below the floor may look around there
    renderer::ViewCamera below = kStartView;
    below.position_m.z() = -1.0;
    EXPECT_LT(apply({.turn_px = {10.0, -5.0}}, below).position_m.z(), -1.0);
}

TEST(Controls, NeverTipTheEyeOver) {
    std::mt19937 random(5);
    std::uniform_real_distribution<> any(-400.0, 400.0);
    renderer::ViewCamera camera = kStartView;
    for (int i = 0; i < 2000; ++i) {
        camera = apply({.turn_px = {any(random), any(random)},
                        .zoom_steps = any(random) / 400.0,
                        .look_around = i % 3 == 0},
                       camera);
        const Eigen::Vector3d view = (camera.target_m - camera.position_m).normalized();
        ASSERT_TRUE(view.allFinite());
        ASSERT_LT(std::abs(view.z()), 0.9999);
    }
}

}  // namespace
}  // namespace atrium::viewer
