#include "viewer/control/mouse_grab.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <numbers>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;
constexpr int kWidth = 640;
constexpr int kHeight = 480;

renderer::ViewCamera looking_north() {
    return {.position_m = {0, -3, 1}, .target_m = {0, 0, 1}, .fov_deg = 50.0};
}

Pointer at(const renderer::ViewCamera& camera, const Eigen::Vector3d& p_world, bool is_down) {
    return {.at_px = renderer::project_px(camera, p_world, kWidth, kHeight),
            .is_down = is_down,
            .width_px = kWidth,
            .height_px = kHeight};
}

bus::SceneObject thing(bus::Shape shape, double size_m) {
    bus::SceneObject object;
    object.object = 7;
    object.shape = shape;
    object.size_m.setConstant(size_m);
    object.mass_kg = 1.0;
    return object;
}

TEST(RayThrough, InvertsTheProjection) {
    const renderer::ViewCamera camera{
        .position_m = {2, -3, 1.5}, .target_m = {-0.5, 0.3, 0.8}, .fov_deg = 63.0};
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 1), {-1, 1, 0.2}, {1.2, -0.4, 2}}) {
        const Ray ray = ray_through(camera, at(camera, p, false));
        const Eigen::Vector3d way = p - ray.origin;
        EXPECT_LT((way - way.dot(ray.direction) * ray.direction).norm(), 1e-9);
        EXPECT_GT(way.dot(ray.direction), 0.0);
        EXPECT_NEAR(ray.direction.norm(), 1.0, 1e-12);
    }
}

TEST(Hit, IsWhereTheRayEnters) {
    const Ray ray{{0, -3, 1}, {0, 1, 0}};
    const geometry::RigidTransform here{Eigen::Quaterniond::Identity(), {0.05, 0, 1}};
    const auto box = hit(ray, thing(bus::Shape::kBox, 0.4), here);
    ASSERT_TRUE(box);
    EXPECT_EQ(box->object, 7U);
    EXPECT_NEAR(box->distance_m, 2.8, 1e-12);
    EXPECT_TRUE(box->point_object.isApprox(Eigen::Vector3d(-0.05, -0.2, 0)));
    const auto ball = hit(ray, thing(bus::Shape::kSphere, 0.4), here);
    ASSERT_TRUE(ball);
    EXPECT_NEAR(ball->point_object.norm(), 0.2, 1e-12);

    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::UnitZ()));
    const auto edge = hit(ray, thing(bus::Shape::kBox, 0.4), {turn, {0, 0, 1}});
    ASSERT_TRUE(edge);
    EXPECT_NEAR(edge->distance_m, 3.0 - 0.2 * std::numbers::sqrt2, 1e-9);

    const geometry::RigidTransform aside{Eigen::Quaterniond::Identity(), {0.3, 0, 1}};
    EXPECT_FALSE(hit(ray, thing(bus::Shape::kBox, 0.4), aside));
    EXPECT_FALSE(hit(ray, thing(bus::Shape::kSphere, 0.4), aside));
    const geometry::RigidTransform behind{Eigen::Quaterniond::Identity(), {0, -5, 1}};
    EXPECT_FALSE(hit(ray, thing(bus::Shape::kBox, 0.4), behind));
    EXPECT_FALSE(hit(ray, thing(bus::Shape::kSphere, 0.4), behind));
}

TEST(Hit, OfASoftObjectIsOnItsFacesOrNearItsRope) {
    const Ray ray{{0, -3, 1}, {0, 1, 0}};
    bus::SoftBody body;
    body.object = 9;
    body.num_nodes = 3;
    body.triangles = {{0, 1, 2}};
    const std::vector<Eigen::Vector3f> nodes{{-1, 0.5F, 0.5F}, {1, 0.5F, 0.5F}, {0, 0.5F, 2}};
    const auto face = hit(ray, body, nodes);
    ASSERT_TRUE(face);
    EXPECT_EQ(face->object, 9U);
    EXPECT_NEAR(face->distance_m, 3.5, 1e-9);
    EXPECT_TRUE(face->point_object.isApprox(Eigen::Vector3d(0, 0.5, 1), 1e-9))
        << "the point must be in world coordinates";
    body.triangles = {{0, 2, 1}};
    EXPECT_TRUE(hit(ray, body, nodes)) << "a hit from behind must count";
    EXPECT_FALSE(hit({{0, -3, 3}, {0, 1, 0}}, body, nodes)) << "a ray above the object";
    EXPECT_FALSE(hit({{0, 3, 1}, {0, 1, 0}}, body, nodes)) << "an object behind the eye";
    EXPECT_FALSE(hit(ray, body, {nodes.data(), 2})) << "an object whose nodes are unknown";

    body.triangles.clear();
    body.segments = {{0, 1}};  // 0.5 m below the ray
    body.thickness_m = 0.02;
    EXPECT_FALSE(hit(ray, body, nodes));
    const auto rope = hit({{0.3, -3, 0.515}, {0, 1, 0}}, body, nodes);
    ASSERT_TRUE(rope);
    EXPECT_NEAR(rope->distance_m, 3.5, 1e-6);
    EXPECT_FALSE(hit({{1.1, -3, 0.5}, {0, 1, 0}}, body, nodes)) << "a ray beyond the rope's end";
}

class MouseGrabTest : public testing::Test {
protected:
    std::vector<bus::SceneCommand> update(const Eigen::Vector3d& p_world, bool is_down) {
        now_ += 20ms;
        return grab_.update(
            at(camera_, p_world, is_down),
            camera_,
            [this](const Ray& ray) {
                return hit(ray, thing(bus::Shape::kBox, 0.4), world_from_object_);
            },
            now_);
    }

    renderer::ViewCamera camera_ = looking_north();
    geometry::RigidTransform world_from_object_{Eigen::Quaterniond::Identity(), {0, 0.2, 1}};
    MouseGrab grab_{"eve"};
    MouseGrab::Clock::time_point now_{};
};

TEST_F(MouseGrabTest, PullsInThePlaneFacingTheCameraAndReleases) {
    const Eigen::Vector3d front(0.1, 0.0, 1.1);  // point of the box where the ray enters
    const auto pressed = update(front, true);
    ASSERT_EQ(pressed.size(), 1U);
    EXPECT_EQ(pressed[0].kind, bus::CommandKind::kGrab);
    EXPECT_EQ(pressed[0].sender, "eve");
    EXPECT_EQ(pressed[0].target, 7U);
    EXPECT_TRUE(pressed[0].point_object.isApprox(Eigen::Vector3d(0.1, -0.2, 0.1), 1e-9));
    EXPECT_TRUE(pressed[0].goal_world.isApprox(front, 1e-9));
    EXPECT_TRUE(grab_.is_holding());

    const Eigen::Vector3d there(0.7, 0.0, 1.6);
    const auto moved = update(there, true);
    ASSERT_EQ(moved.size(), 1U);
    EXPECT_EQ(moved[0].kind, bus::CommandKind::kMove);
    EXPECT_TRUE(moved[0].goal_world.isApprox(there, 1e-9))
        << "the goal must keep the distance of the grab";

    const auto released = update(there, false);
    ASSERT_EQ(released.size(), 1U);
    EXPECT_EQ(released[0].kind, bus::CommandKind::kRelease);
    EXPECT_EQ(released[0].target, 7U);
    EXPECT_FALSE(grab_.is_holding());
    EXPECT_TRUE(update(there, false).empty());
}

TEST_F(MouseGrabTest, IgnoresDragsThatBeginBesideAnObject) {
    EXPECT_TRUE(update({2, 0, 1}, true).empty());
    EXPECT_FALSE(grab_.is_holding());
    EXPECT_TRUE(update({0, 0, 1}, true).empty()) << "the button was pressed beside the box";
    EXPECT_FALSE(grab_.is_holding());
}

TEST_F(MouseGrabTest, RepeatsTheGrabWhileHolding) {
    ASSERT_EQ(update({0, 0, 1}, true).size(), 1U);
    int num_commands = 0;
    for (int i = 0; i < 100; ++i)  // 2 s without a motion
        num_commands += static_cast<int>(update({0, 0, 1}, true).size());
    EXPECT_GE(num_commands, 3);
    EXPECT_LE(num_commands, 5);
}

TEST_F(MouseGrabTest, SendsNoFasterThanTheServerAllows) {
    int num_commands = 0;
    for (int i = 0; i < 1000; ++i) {  // a mouse of 1000 Hz for 1 s
        now_ -= 19ms;
        num_commands += static_cast<int>(update({0.0005 * i, 0, 1}, true).size());
    }
    EXPECT_GE(num_commands, 50);
    EXPECT_LE(num_commands, 70);
}

}  // namespace
}  // namespace atrium::viewer
