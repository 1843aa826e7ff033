// Soft objects on solid scenery, whose faces they must not pass.
#include "soft_stage.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace atrium::physics {
namespace {

using physics_test::make_box_mesh;

constexpr double kTop_m = 1.0;
constexpr std::uint32_t kDroppedBall = 8;

// A table top of 1 x 0.8 m: one face without an inside, or a closed box.
geometry::TriangleMesh table_top(double thick_m, int num_cuts) {
    if (thick_m > 0.0)
        return make_box_mesh({1.0, 0.8, thick_m},
                             {Eigen::Quaterniond::Identity(), {0, 0, kTop_m - thick_m / 2.0}},
                             num_cuts);
    geometry::TriangleMesh sheet;
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.4, 0.4}) sheet.vertices.emplace_back(x, y, kTop_m);
    sheet.triangles = {{0, 1, 2}, {2, 1, 3}};
    return sheet;
}

// A wall of 3 x 3 m in the plane y = 0, one face without an inside.
geometry::TriangleMesh wall() {
    geometry::TriangleMesh wall;
    for (const double x : {-1.5, 1.5})
        for (const double z : {0.0, 3.0}) wall.vertices.emplace_back(x, 0.0, z);
    wall.triangles = {{0, 1, 2}, {2, 1, 3}};
    return wall;
}

SoftObject dough_at(const Eigen::Vector3d& position) {
    SoftObject dough = ball_at(position);
    dough.shape = SoftShape::kBox;
    dough.size_m = {0.3, 0.2, 0.1};
    dough.mass_kg = 0.8;
    return dough;
}

class SoftOnScenery : public ::testing::Test {
protected:
    void drop_ball(double mass_kg, double fall_m) {
        RigidObject ball{
            .id = kDroppedBall, .shape = ObjectShape::kSphere, .size_m = {0.2, 0.2, 0.2}};
        ball.mass_kg = mass_kg;
        ball.world_from_object.translation = {0.02, 0.01, kTop_m + 0.2 + fall_m};
        ASSERT_EQ(stage.world.add(ball), AddResult::kAdded);
    }
    double largest_y_m() {
        double most = -1e9;
        for (const Eigen::Vector3f& p : stage.soft().positions)
            most = std::max<double>(most, p.y());
        return most;
    }
    SoftStage stage;
};

class PressedOnScenery : public SoftOnScenery,
                         public ::testing::WithParamInterface<std::tuple<double, double>> {};

TEST_P(PressedOnScenery, StaysOnIt) {
    const auto [thick_m, mass_kg] = GetParam();
    ASSERT_TRUE(stage.world.add_static({.mesh = table_top(thick_m, 4)}));
    ASSERT_EQ(stage.world.add_soft(dough_at({0, 0, kTop_m + 0.06})), AddResult::kAdded);
    stage.run(1.0);
    drop_ball(mass_kg, 0.4);
    double lowest_m = kTop_m, smallest_m3 = 1.0;
    stage.run(6.0, [&] {
        lowest_m = std::min(lowest_m, stage.lowest_m());
        smallest_m3 = std::min(smallest_m3, stage.volume_m3());
    });
    EXPECT_GT(lowest_m, kTop_m - 0.004) << "its skin is 5 mm thick";
    EXPECT_GT(smallest_m3, 0.0) << "it must not turn inside out";
    EXPECT_GT(stage.lowest_m(), kTop_m + 0.002);
    EXPECT_LT(stage.fastest_mps(), 0.005);
    EXPECT_NEAR(stage.volume_m3(), 0.3 * 0.2 * 0.1, 0.0003);
}

INSTANTIATE_TEST_SUITE_P(TopsAndMasses,
                         PressedOnScenery,
                         ::testing::Combine(::testing::Values(0.0, 0.02, 0.4),
                                            ::testing::Values(1.0, 3.0, 10.0)));

TEST_F(SoftOnScenery, HoldsAClothUnderAHeavyBall) {
    ASSERT_TRUE(stage.world.add_static({.mesh = table_top(0.0, 1)}));
    SoftObject cloth;
    cloth.id = kSoft;
    cloth.size_m = {0.7, 0.5, 0.01};
    cloth.mass_kg = 0.3;
    cloth.world_from_object = {
        Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX())),
        {0, 0, kTop_m + 0.02}};
    ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
    stage.run(1.0);
    drop_ball(5.0, 0.5);
    double lowest_m = kTop_m;
    stage.run(4.0, [&] { lowest_m = std::min(lowest_m, stage.lowest_m()); });
    EXPECT_GT(lowest_m, kTop_m - 0.004);
    EXPECT_GT(stage.lowest_m(), kTop_m);
}

TEST_F(SoftOnScenery, StopsWhatIsThrownAtAWall) {
    ASSERT_TRUE(stage.world.add_static({.mesh = wall()}));
    for (const double speed_mps : {3.0, 8.0, 15.0}) {
        SCOPED_TRACE(speed_mps);
        stage.world.remove(kSoft);
        ASSERT_EQ(stage.world.add_soft(ball_at({0, -1.0, 1.5})), AddResult::kAdded);
        stage.throw_soft(kSoft, {0, speed_mps, 0});
        double furthest_m = -1.0;
        stage.run(3.0, [&] { furthest_m = std::max(furthest_m, largest_y_m()); });
        EXPECT_GT(furthest_m, -0.05) << "it must reach the wall";
        EXPECT_LT(largest_y_m(), 0.0) << "it must come back";
    }
}

// Of a thin sheet, a volume keeps the side on which its larger part starts.
TEST_F(SoftOnScenery, FreesWhatStartsInIt) {
    ASSERT_TRUE(stage.world.add_static({.mesh = table_top(0.0, 1)}));
    for (const double above_m : {0.02, -0.02}) {
        SCOPED_TRACE(above_m);
        stage.world.remove(kSoft);
        ASSERT_EQ(stage.world.add_soft(dough_at({0, 0, kTop_m + above_m})), AddResult::kAdded);
        stage.run(4.0);
        EXPECT_NEAR(stage.lowest_m(), above_m > 0.0 ? kTop_m : 0.0, 0.01);
        EXPECT_LT(stage.fastest_mps(), 0.005);
    }
}

TEST_F(SoftOnScenery, KeepsTheSideToWhichAStateMovesIt) {
    ASSERT_TRUE(stage.world.add_static({.mesh = table_top(0.0, 1)}));
    ASSERT_EQ(stage.world.add_soft(dough_at({0, 0, kTop_m + 0.06})), AddResult::kAdded);
    stage.run(1.0);
    SoftState state = stage.soft();
    for (Eigen::Vector3f& p : state.positions) p.z() -= 0.13F;
    ASSERT_TRUE(stage.world.restore_soft(state));
    stage.run(2.0);
    EXPECT_NEAR(stage.lowest_m(), 0.0, 0.01) << "on the floor, below the table";
}

// A viewer that pulls harder than the wall holds does not leave the ball hanging in it.
TEST_F(SoftOnScenery, LetsGoOfWhatIsPulledThroughIt) {
    ASSERT_TRUE(stage.world.add_static({.mesh = wall()}));
    ASSERT_EQ(stage.world.add_soft(ball_at({0, -0.4, 0.2})), AddResult::kAdded);
    stage.run(0.5);
    ASSERT_TRUE(stage.world.grab("eve", kSoft, stage.centre(), stage.centre()));
    for (int i = 0; i < 30; ++i) {
        ASSERT_TRUE(stage.world.move_grab("eve", kSoft, {0, 2.0, 0.5}));
        stage.run(0.1);
    }
    ASSERT_TRUE(stage.world.release("eve", kSoft));
    stage.run(5.0);
    EXPECT_LT(stage.fastest_mps(), 0.01);
    EXPECT_NEAR(stage.lowest_m(), 0.0, 0.01);
    double nearest_m = 1.0;
    for (const Eigen::Vector3f& p : stage.soft().positions)
        nearest_m = std::min<double>(nearest_m, std::abs(p.y()));
    EXPECT_GT(nearest_m, 0.0);
}

TEST_F(SoftOnScenery, HoldsItInACorner) {
    ASSERT_TRUE(stage.world.add_static({.mesh = wall()}));
    ASSERT_TRUE(stage.world.add_static({.mesh = table_top(0.0, 1)}));
    ASSERT_EQ(stage.world.add_soft(dough_at({0, -0.12, kTop_m + 0.06})), AddResult::kAdded);
    stage.run(1.0);
    for (int i = 0; i < 10; ++i) {
        stage.throw_soft(kSoft, {0, 3.0, -2.0});
        stage.run(0.3);
        EXPECT_LT(largest_y_m(), 0.0) << i;
        EXPECT_GT(stage.lowest_m(), kTop_m - 0.01) << i;
    }
    stage.run(2.0);
    EXPECT_GT(stage.lowest_m(), kTop_m);
    EXPECT_LT(stage.fastest_mps(), 0.005);
}

}  // namespace
}  // namespace atrium::physics
