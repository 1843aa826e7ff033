#include "viewer/control/controls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
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

TEST(Controls, OneDragAfterTheOtherStopsAtTheFloor) {
    for (const double target_z_m : {-3.0, -0.2, 0.0, 0.03, 0.4, 0.5, 0.6, 1.0}) {
        renderer::ViewCamera camera{.position_m = {0.5, -6.0, 2.6},
                                    .target_m = {0.0, 0.5, target_z_m}};
        const double before_m = distance(camera);
        for (int i = 0; i < 158; ++i) {
            camera = apply({.turn_px = {0.0, -1.0}}, camera);
            ASSERT_GE(camera.position_m.z(), 0.05) << "target at " << target_z_m << ", pixel " << i;
        }
        EXPECT_NEAR(camera.position_m.z(), 0.05, 1e-9) << "target at " << target_z_m;
        EXPECT_NEAR(distance(camera), before_m, 1e-9) << "an orbit keeps its distance";
    }
}

TEST(Controls, PanStopsTheEyeAtTheFloorAndOrbitKeepsItThere) {
    renderer::ViewCamera camera;
    for (int i = 0; i < 2000; ++i) {
        camera = apply({.pan_px = {0.0, -5.0}}, camera);
        ASSERT_GE(camera.position_m.z(), 0.05) << i;
    }
    EXPECT_LT(camera.target_m.z(), -0.3);
    for (int i = 0; i < 300; ++i) {
        camera = apply({.turn_px = {1.0, -3.0}}, camera);
        ASSERT_GE(camera.position_m.z(), 0.05) << i;
    }
}

TEST(Controls, ZoomTowardsATargetBelowTheFloorStopsOnTheWay) {
    const renderer::ViewCamera start{.position_m = {0.5, -6.0, 2.6}, .target_m = {0.0, 0.5, -1.0}};
    const auto near = apply({.zoom_steps = 40.0}, start);
    EXPECT_NEAR(near.position_m.z(), 0.05, 1e-12);
    const Eigen::Vector3d way = start.position_m - start.target_m;
    EXPECT_LT((near.position_m - near.target_m).cross(way).norm(), 1e-9) << "along the view";
    EXPECT_NEAR(
        apply({.zoom_steps = -5.0}, near).position_m.z(), 1.05 / std::pow(0.88, 5.0) - 1.0, 1e-9)
        << "the way back is open";
}

TEST(Controls, NoDragsTakeTheEyeThroughTheFloor) {
    std::mt19937 random(11);
    std::uniform_real_distribution<> any(-1.0, 1.0);
    for (int trial = 0; trial < 400; ++trial) {
        renderer::ViewCamera camera{
            .position_m = {4.0 * any(random), 4.0 * any(random), 2.0 + 1.9 * any(random)},
            .target_m = {4.0 * any(random), 4.0 * any(random), 3.0 * any(random)}};
        // by turns, as hands do, and all at once
        for (int i = 0; i < 100; ++i) {
            Motion motion;
            const int kind = trial % 4 == 0 ? 3 : i / 20 % 4;
            if (kind == 0 || kind == 3) motion.turn_px = {90.0 * any(random), 90.0 * any(random)};
            if (kind == 1 || kind == 3) motion.zoom_steps = 4.0 * any(random);
            if (kind == 2 || kind == 3) motion.pan_px = {90.0 * any(random), 90.0 * any(random)};
            motion.look_around = i % 7 == 0;
            camera = apply(motion, camera);
            ASSERT_GE(camera.position_m.z(), 0.05) << trial << ", motion " << i;
            ASSERT_TRUE(camera.position_m.allFinite() && camera.target_m.allFinite());
            const Eigen::Vector3d view = (camera.target_m - camera.position_m).normalized();
            ASSERT_LT(std::abs(view.z()), 0.9999);
        }
    }
}

TEST(Controls, AnEyeBelowTheFloorIsFree) {
    renderer::ViewCamera camera{.position_m = {0.5, -6.0, -1.0}, .target_m = {0.0, 0.5, -0.5}};
    EXPECT_LT(apply({.turn_px = {0.0, -50.0}}, camera).position_m.z(), -2.0);
    EXPECT_LT(apply({.pan_px = {0.0, -50.0}}, camera).position_m.z(), -1.1);
    const auto above = apply({.turn_px = {0.0, 100.0}}, camera);
    EXPECT_GT(above.position_m.z(), 1.0) << "it may come up";
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
