// Soft objects that a viewer holds.
#include "soft_stage.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace atrium::physics {
namespace {

class SoftGrab : public testing::Test {
protected:
    Eigen::Vector3d node(std::size_t i) { return stage.soft().positions[i].cast<double>(); }

    SoftStage stage;
};

TEST_F(SoftGrab, LiftsABallByItsSkinAndReleasesIt) {
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.18})), AddResult::kAdded);
    stage.run(1.0);
    const double before_m3 = stage.volume_m3();
    const Eigen::Vector3d goal(0.5, -0.3, 1.2);
    ASSERT_TRUE(stage.world.grab("eve", kSoft, stage.centre() + Eigen::Vector3d(0, 0, 0.15), goal));
    stage.run(2.0 + kTickS);
    EXPECT_EQ(stage.world.num_grabs(), 0U) << "a grab must end after 2 s without an update";
    stage.run(1.0);
    EXPECT_LT(stage.centre().z(), 0.2) << "it fell";

    ASSERT_TRUE(stage.world.grab("eve", kSoft, stage.centre() + Eigen::Vector3d(0, 0, 0.15), goal));
    stage.run(1.9);
    EXPECT_LT((stage.centre() - goal).norm(), 0.35) << "the ball must hang from its goal";
    EXPECT_NEAR(stage.centre().x(), goal.x(), 0.05);
    EXPECT_NEAR(stage.volume_m3() / before_m3, 1.0, 0.1);
    EXPECT_EQ(stage.world.counters().num_torn, 0U);
}

TEST_F(SoftGrab, PulledClothCornerSwingsBack) {
    ASSERT_EQ(stage.world.add_soft(curtain_at({0, 0, 1.1})), AddResult::kAdded);
    stage.run(1.0);
    const std::size_t corner = stage.soft().positions.size() - 1;
    const Eigen::Vector3d at = node(corner);
    const Eigen::Vector3d goal = at + Eigen::Vector3d(-0.1, -0.6, 0.4);
    ASSERT_TRUE(stage.world.grab("eve", kSoft, at, at));
    ASSERT_TRUE(stage.world.move_grab("eve", kSoft, goal));
    stage.run(1.5);
    EXPECT_LT((node(corner) - goal).norm(), 0.03);
    ASSERT_TRUE(stage.world.release("eve", kSoft));
    EXPECT_FALSE(stage.world.release("eve", kSoft));
    stage.run(6.0);
    EXPECT_LT((node(corner) - at).norm(), 0.1);
}

TEST_F(SoftGrab, HasBoundedForce) {
    ASSERT_EQ(stage.world.add_soft(curtain_at({0, 0, 1.1})), AddResult::kAdded);
    stage.run(0.5);
    const Eigen::Vector3d hem(0, 0, 0.15);
    ASSERT_TRUE(stage.world.grab("eve", kSoft, hem, hem + Eigen::Vector3d(0, -20, 0)));
    for (int i = 0; i < 5; ++i) {
        stage.run(1.0);
        ASSERT_TRUE(stage.world.move_grab("eve", kSoft, hem + Eigen::Vector3d(0, -20, 0)));
    }
    EXPECT_EQ(stage.world.counters().num_torn, 0U) << "the pins must hold against 80 m/s^2";
    double furthest_m = 0.0;
    for (const Eigen::Vector3f& p : stage.soft().positions)
        furthest_m = std::max<double>(furthest_m, -p.y());
    EXPECT_LT(furthest_m, 2.6) << "of 1.9 m of cloth";
}

TEST_F(SoftGrab, EndsWithItsHolderAndItsObject) {
    ASSERT_EQ(stage.world.add_soft(ball_at({0, 0, 0.5})), AddResult::kAdded);
    ASSERT_TRUE(stage.world.grab("eve", kSoft, {0, 0, 0.5}, {0, 0, 1}));
    ASSERT_TRUE(stage.world.grab("bob", kSoft, {0, 0, 0.5}, {0, 0, 1}));
    stage.world.release_all("eve");
    EXPECT_EQ(stage.world.num_grabs(), 1U);
    ASSERT_TRUE(stage.world.remove(kSoft));
    EXPECT_EQ(stage.world.num_grabs(), 0U);
    stage.run(0.1);
}

TEST_F(SoftGrab, RefusesInvalidArguments) {
    SoftObject frame = curtain_at({0, 0, 1.1});
    frame.size_m = {0.1, 0.1, 0.01};
    frame.spacing_m = 0.1;
    frame.pins = {{PinPlace::kCorners}};
    ASSERT_EQ(stage.world.add_soft(frame), AddResult::kAdded);
    EXPECT_FALSE(stage.world.grab("eve", kSoft, {0, 0, 1.1}, {0, 0, 2}))
        << "an object without movable nodes must be refused";
    EXPECT_FALSE(stage.world.grab("eve", 99, {0, 0, 1.1}, {0, 0, 2}));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    SoftObject ball = ball_at({0, 0, 1});
    ball.id = 51;
    ASSERT_EQ(stage.world.add_soft(ball), AddResult::kAdded);
    EXPECT_FALSE(stage.world.grab("eve", 51, {0, nan, 1}, {0, 0, 2}));
    EXPECT_FALSE(stage.world.grab("eve", 51, {0, 0, 1}, {0, 0, nan}));
    EXPECT_TRUE(stage.world.grab("eve", 51, {0, 0, 1}, {0, 0, 2}));
}

}  // namespace
}  // namespace atrium::physics
