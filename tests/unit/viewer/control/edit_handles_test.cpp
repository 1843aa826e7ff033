#include "viewer/control/edit_handles.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace atrium::viewer {
namespace {

constexpr int kHandleWidth = 800;
constexpr int kHandleHeight = 600;

renderer::EyeView handle_eye(const Eigen::Vector3d& from = {1.5, -3.0, 2.0}) {
    return renderer::eye_of({.position_m = from, .target_m = {0, 0, 0.5}, .fov_deg = 50.0},
                            kHandleWidth,
                            kHandleHeight);
}

Pointer pointer_at(const Eigen::Vector3d& p_world, const renderer::EyeView& eye) {
    return {.at_px = *pixel_of(p_world, eye),
            .is_down = true,
            .width_px = kHandleWidth,
            .height_px = kHandleHeight};
}

EditHandles handles_at(const Eigen::Vector3d& position, HandleMode mode) {
    EditHandles handles;
    handles.mode = mode;
    handles.world_from_object.translation = position;
    return handles;
}

TEST(EditHandles, RayAndPixelAreInverse) {
    const renderer::EyeView eye = handle_eye();
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), {0.7, 0.4, 1.1}, {-1, 0.3, 0.2}}) {
        const Ray ray = ray_of(*pixel_of(p, eye), eye);
        EXPECT_LT((p - ray.origin).cross(ray.direction).norm(), 1e-9);
        EXPECT_GT((p - ray.origin).dot(ray.direction), 0.0);
    }
    EXPECT_FALSE(pixel_of({3.0, -6.0, 3.5}, eye)) << "behind the eye";
}

TEST(EditHandles, HaveOneSizeInThePictureAtAnyDistance) {
    for (const double distance : {1.0, 3.0, 20.0}) {
        const renderer::EyeView eye = handle_eye({0.0, -distance, 0.5});
        const EditHandles handles = handles_at({0, 0, 0.5}, HandleMode::kMove);
        const double length_m = handles.metres(EditHandles::kLength, eye);
        const Eigen::Vector2d from = *pixel_of({0, 0, 0.5}, eye);
        const Eigen::Vector2d to = *pixel_of({length_m, 0, 0.5}, eye);
        EXPECT_NEAR((to - from).norm(), EditHandles::kLength * kHandleHeight, 0.5);
    }
}

TEST(EditHandles, ArrowFollowsThePointerAlongItsAxisOnly) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> any(-0.4, 0.4);
    for (int i = 0; i < 200; ++i) {
        const renderer::EyeView eye = handle_eye();
        EditHandles handles = handles_at({any(random), any(random), 0.5}, HandleMode::kMove);
        handles.is_local = i % 2 == 0;
        handles.world_from_object.rotation =
            Eigen::AngleAxisd(any(random), Eigen::Vector3d::UnitX());
        const Handle handle = i % 3;
        const Eigen::Vector3d grip =
            handles.world_from_object.translation +
            0.8 * handles.metres(EditHandles::kLength, eye) * handles.axis(handle);
        const Pointer pressed = pointer_at(grip, eye);
        ASSERT_EQ(handles.pick(pressed, eye), handle) << i;
        HandleDrag drag(handles, handle, pressed, eye);
        const double way_m = any(random);
        // and a little beside the axis, which must not count
        const Pointer moved = pointer_at(grip + way_m * handles.axis(handle), eye);
        const geometry::RigidTransform pose = drag.update(moved, eye, false);
        const Eigen::Vector3d shift = pose.translation - handles.world_from_object.translation;
        EXPECT_NEAR(shift.dot(handles.axis(handle)), way_m, 1e-6);
        EXPECT_LT(shift.cross(handles.axis(handle)).norm(), 1e-9);
        EXPECT_EQ(pose.rotation.coeffs(), handles.world_from_object.rotation.coeffs());
        const Eigen::Vector3d steps =
            drag.update(moved, eye, true).translation - handles.world_from_object.translation;
        EXPECT_NEAR(steps.norm(), 0.1 * std::abs(std::round(way_m / 0.1)), 1e-9);
    }
}

TEST(EditHandles, MiddleMovesInThePlaneOfThePictureAndXConstrainsIt) {
    const renderer::EyeView eye = handle_eye();
    const EditHandles handles = handles_at({0, 0, 0.5}, HandleMode::kMove);
    const Pointer pressed = pointer_at({0, 0, 0.5}, eye);
    ASSERT_EQ(handles.pick(pressed, eye), kMiddleHandle);
    HandleDrag drag(handles, kMiddleHandle, pressed, eye);
    const Eigen::Vector3d right = eye.view_from_world.row(0).head<3>().transpose();
    const Pointer moved = pointer_at(Eigen::Vector3d(0, 0, 0.5) + 0.3 * right, eye);
    EXPECT_LT(
        (drag.update(moved, eye, false).translation - Eigen::Vector3d(0, 0, 0.5) - 0.3 * right)
            .norm(),
        1e-6);
    drag.constrain(0, moved, eye);
    const Eigen::Vector3d shift =
        drag.update(moved, eye, false).translation - Eigen::Vector3d(0, 0, 0.5);
    EXPECT_GT(shift.x(), 0.1);
    EXPECT_EQ(shift.y(), 0.0);
    EXPECT_EQ(shift.z(), 0.0);
    EXPECT_THAT(drag.readout(), testing::StartsWith("x +0."));
}

TEST(EditHandles, RingTurnsByTheAngleOfThePointerOverMoreThanATurn) {
    const renderer::EyeView eye = handle_eye();
    const EditHandles handles = handles_at({0, 0, 0.5}, HandleMode::kRotate);
    const double radius_m = handles.metres(EditHandles::kRadius, eye);
    const Pointer pressed = pointer_at(handles.ring_point(2, -0.6, radius_m), eye);
    ASSERT_EQ(handles.pick(pressed, eye), 2);
    HandleDrag drag(handles, 2, pressed, eye);
    geometry::RigidTransform pose;
    constexpr double kTurn = 7.0;  // rad
    for (int i = 1; i <= 70; ++i) {
        const Eigen::Vector3d at = handles.ring_point(2, -0.6 + kTurn * i / 70.0, radius_m);
        pose = drag.update(pointer_at(at, eye), eye, false);
    }
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(kTurn, Eigen::Vector3d::UnitZ()));
    EXPECT_LT(pose.rotation.angularDistance(expected), 1e-6);
    EXPECT_EQ(drag.readout(), "z +401.1 deg");
    EXPECT_EQ(pose.translation, handles.world_from_object.translation);
}

// The ring is a line; the way along it counts.
TEST(EditHandles, RingSeenFromItsSideTurnsToo) {
    const renderer::EyeView eye = handle_eye({0.0, -3.0, 0.5});
    const EditHandles handles = handles_at({0, 0, 0.5}, HandleMode::kRotate);
    const Pointer pressed = pointer_at({0, 0, 0.5}, eye);
    HandleDrag drag(handles, 2, pressed, eye);
    Pointer moved = pressed;
    moved.at_px.x() += EditHandles::kRadius * kHandleHeight;
    const geometry::RigidTransform pose = drag.update(moved, eye, false);
    const Eigen::AngleAxisd turn(pose.rotation);
    EXPECT_NEAR(turn.angle(), 1.0, 0.15) << "a radius is a radian";
    EXPECT_NEAR(turn.axis().z(), 1.0, 1e-9) << "the near side goes to the right";
}

}  // namespace
}  // namespace atrium::viewer
