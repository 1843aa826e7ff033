// Rigid objects at rest that carry soft objects, or lie on them.
#include "soft_stage.hpp"
#include "tests/support/sanitized.hpp"
#include "world_server/physics/options/soft_options.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <vector>

namespace atrium::physics {
namespace {

using physics_test::make_box_mesh;

constexpr std::uint32_t kTable = 7;
constexpr double kLong_s = test::kSanitized ? 30.0 : 60.0;
constexpr double kShort_s = test::kSanitized ? 10.0 : 20.0;

// A table of 1.2 x 0.7 m, 74 cm high, that stands on four legs on the floor.
RigidObject table() {
    std::vector<geometry::TriangleMesh> parts;
    const auto add_part = [&](const Eigen::Vector3d& size, const Eigen::Vector3d& middle) {
        parts.push_back(make_box_mesh(size, {Eigen::Quaterniond::Identity(), middle}, 1));
    };
    add_part({1.2, 0.7, 0.04}, {0, 0, 0.72});
    for (const double x : {-0.54, 0.54})
        for (const double y : {-0.29, 0.29}) add_part({0.06, 0.06, 0.7}, {x, y, 0.35});
    RigidObject object;
    object.id = kTable;
    object.shape = ObjectShape::kCompound;
    object.size_m = extents_of(parts);
    object.parts = std::make_shared<const std::vector<geometry::TriangleMesh>>(parts);
    object.mass_kg = 18.0;
    object.friction = 0.5;
    return object;
}

// Of 0.7 x 0.5 m, horizontal.
SoftObject tablecloth_at(const Eigen::Vector3d& position) {
    SoftObject cloth;
    cloth.id = kSoft;
    cloth.size_m = {0.7, 0.5, 0.01};
    cloth.mass_kg = 0.3;
    cloth.damping_hz = 1.5;
    cloth.world_from_object = {
        Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitX())),
        position};
    return cloth;
}

// The floor has friction 0.8.
class SoftRest : public ::testing::Test {
protected:
    SoftRest() {
        stage.world.remove(1);
        stage.world.add(
            {.id = 1, .shape = ObjectShape::kPlane, .size_m = {10, 10, 0}, .friction = 0.8});
    }
    bool sleeps(std::uint32_t id) {
        const RigidState state = stage.rigid(id);
        return state.linear_velocity.isZero(0.0) && state.angular_velocity.isZero(0.0);
    }
    SoftStage stage;
};

TEST_F(SoftRest, TableUnderACloth) {
    // wholly on the table, and with its edge 10 cm beyond that of the table
    for (const double over_m : {0.0, 0.1}) {
        stage.world.remove(kTable);
        stage.world.remove(kSoft);
        ASSERT_EQ(stage.world.add(table()), AddResult::kAdded);
        const SoftObject cloth = tablecloth_at({-0.25 - over_m, 0.0, 0.85});
        ASSERT_EQ(stage.world.add_soft(cloth), AddResult::kAdded);
        stage.run(over_m > 0.0 ? kLong_s : kShort_s);
        const RigidState state = stage.rigid(kTable);
        EXPECT_LT(state.world_from_object.translation.norm(), 0.001) << over_m;
        EXPECT_LT(state.world_from_object.rotation.vec().norm(), 0.001) << over_m;
        EXPECT_TRUE(sleeps(kTable)) << over_m;
        EXPECT_LT(stage.fastest_mps(), 0.001) << over_m << ": the cloth must not slide off";
        if (over_m == 0.1) {
            EXPECT_NEAR(stage.lowest_m(), 0.74 - over_m, 0.02);
        }
    }
}

TEST_F(SoftRest, TableUnderASoftBall) {
    ASSERT_EQ(stage.world.add(table()), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(ball_at({0.3, 0.1, 0.95})), AddResult::kAdded);
    stage.run(20.0);
    EXPECT_LT(stage.rigid(kTable).world_from_object.translation.norm(), 0.001);
    EXPECT_TRUE(sleeps(kTable));
}

// Each carrier is lighter than the soft box on it, or hardly heavier.
class SoftBoxOnCarriers : public SoftRest {
protected:
    void put_box(const Eigen::Vector3d& position) {
        SoftObject box = ball_at(position);
        box.shape = SoftShape::kBox;
        box.size_m = {0.3, 0.3, 0.2};
        box.spacing_m = 0.06;
        box.mass_kg = 2.0;
        box.stiffness = 0.4;
        ASSERT_EQ(stage.world.add_soft(box), AddResult::kAdded);
    }
    void expect_rest(std::uint32_t carrier,
                     const Eigen::Vector3d& start,
                     double box_z_m,
                     double most_m) {
        const RigidState state = stage.rigid(carrier);
        EXPECT_LT((state.world_from_object.translation - start).norm(), most_m);
        EXPECT_LT(state.world_from_object.rotation.vec().norm(), 0.003);
        EXPECT_LT(stage.centre().head<2>().norm(), 0.02);
        EXPECT_NEAR(stage.centre().z(), box_z_m, 0.03);
        EXPECT_TRUE(sleeps(carrier));
    }
};

TEST_F(SoftBoxOnCarriers, Plates) {
    for (const double mass_kg : {0.1, 0.5, 3.0}) {
        SCOPED_TRACE(mass_kg);
        stage.world.remove(kSoft);
        stage.world.remove(8);
        RigidObject plate{.id = 8, .size_m = {0.32, 0.32, 0.04}, .mass_kg = mass_kg};
        plate.world_from_object.translation.z() = 0.02;
        ASSERT_EQ(stage.world.add(plate), AddResult::kAdded);
        put_box({0, 0, 0.145});
        stage.run(15.0);
        expect_rest(8, plate.world_from_object.translation, 0.14, 0.003);
    }
}

TEST_F(SoftBoxOnCarriers, PlateOnATable) {
    ASSERT_EQ(stage.world.add(table()), AddResult::kAdded);
    RigidObject plate{.id = 8, .size_m = {0.32, 0.32, 0.04}, .mass_kg = 0.3};
    plate.world_from_object.translation.z() = 0.76;
    ASSERT_EQ(stage.world.add(plate), AddResult::kAdded);
    put_box({0, 0, 0.885});
    stage.run(15.0);
    expect_rest(8, plate.world_from_object.translation, 0.88, 0.003);
    EXPECT_LT(stage.rigid(kTable).world_from_object.translation.norm(), 0.001);
}

TEST_F(SoftBoxOnCarriers, Stool) {
    for (const double fall_m : {0.005, 0.3}) {
        SCOPED_TRACE(fall_m);
        stage.world.remove(kSoft);
        stage.world.remove(kTable);
        RigidObject stool = table();
        std::vector<geometry::TriangleMesh> parts;
        const auto add_part = [&](const Eigen::Vector3d& size, const Eigen::Vector3d& middle) {
            parts.push_back(make_box_mesh(size, {Eigen::Quaterniond::Identity(), middle}, 1));
        };
        add_part({0.32, 0.32, 0.04}, {0, 0, 0.42});
        add_part({0.04, 0.04, 0.4}, {0.12, 0, 0.2});
        add_part({0.04, 0.04, 0.4}, {-0.12, -0.12, 0.2});
        add_part({0.04, 0.04, 0.4}, {-0.12, 0.12, 0.2});
        stool.size_m = extents_of(parts);
        stool.parts = std::make_shared<const std::vector<geometry::TriangleMesh>>(parts);
        stool.mass_kg = 3.0;
        ASSERT_EQ(stage.world.add(stool), AddResult::kAdded);
        put_box({0, 0, 0.54 + fall_m});
        stage.run(15.0);
        // a fall pushes the stool
        expect_rest(kTable, Eigen::Vector3d::Zero(), 0.54, fall_m < 0.01 ? 0.003 : 0.02);
    }
}

TEST_F(SoftBoxOnCarriers, BoardThatOverhangs) {
    RigidObject block{.id = 9, .size_m = {0.5, 0.5, 0.4}};
    block.world_from_object.translation.z() = 0.2;
    ASSERT_EQ(stage.world.add(block), AddResult::kAdded);
    for (const double x_m : {0.0, 0.45}) {
        SCOPED_TRACE(x_m);
        stage.world.remove(kSoft);
        stage.world.remove(8);
        RigidObject board{.id = 8, .size_m = {1.2, 0.4, 0.02}, .mass_kg = 1.0};
        board.world_from_object.translation.z() = 0.41;
        ASSERT_EQ(stage.world.add(board), AddResult::kAdded);
        put_box({x_m, 0, 0.525});
        stage.run(10.0);
        // 2 kg, 20 cm beyond the edge, tip a board of 1 kg whose middle is 25 cm before it
        if (x_m > 0.0) {
            EXPECT_LT(stage.rigid(8).world_from_object.translation.z(), 0.35);
        } else {
            expect_rest(8, board.world_from_object.translation, 0.52, 0.003);
        }
    }
}

// Of foam: up to 40 times as heavy as the mat.
TEST_F(SoftRest, HeavyBoxesOnAMat) {
    for (const double stiffness : {0.2, 1.0}) {
        for (const double mass_kg : {15.0, 35.0, 60.0}) {
            if (test::kSanitized && mass_kg != 35.0) continue;  // the same code, ten times as slow
            SCOPED_TRACE(mass_kg);
            SCOPED_TRACE(stiffness);
            stage.world.remove(kSoft);
            stage.world.remove(8);
            SoftObject mat = ball_at({0, 0, 0.06});
            mat.shape = SoftShape::kBox;
            mat.size_m = {0.6, 0.6, 0.1};
            mat.spacing_m = 0.05;
            mat.mass_kg = 1.44;
            mat.stiffness = stiffness;
            ASSERT_EQ(stage.world.add_soft(mat), AddResult::kAdded);
            RigidObject box{.id = 8, .size_m = {0.35, 0.3, 0.3}, .mass_kg = mass_kg};
            box.world_from_object.translation.z() = 0.29;
            ASSERT_EQ(stage.world.add(box), AddResult::kAdded);
            stage.run(12.0);
            const geometry::RigidTransform pose = stage.rigid(8).world_from_object;
            EXPECT_GT((pose.rotation * Eigen::Vector3d::UnitZ()).z(), std::cos(0.1));
            EXPECT_LT(pose.translation.head<2>().norm(), 0.06);
            EXPECT_NEAR(pose.translation.z() - 0.15, 0.09, 0.02);
            EXPECT_NEAR(stage.volume_m3(), 0.6 * 0.6 * 0.1, 0.002);
        }
    }
}

// They bounce little, stay flat, and never get inside.
TEST_F(SoftRest, HeavyBoxesThatFallOnAMat) {
    struct Fall {
        double mass_kg, height_m, stiffness, spacing_m;
    };
    for (const Fall& fall : {Fall{60, 2.0, 0.8, 0.1},
                             Fall{60, 2.0, 0.5, 0.05},
                             Fall{20, 1.2, 0.5, 0.07},
                             Fall{5, 1.2, 0.5, 0.1}}) {
        if (test::kSanitized && fall.mass_kg != 20.0) continue;
        SCOPED_TRACE(fall.mass_kg);
        SCOPED_TRACE(fall.spacing_m);
        stage.world.remove(kSoft);
        stage.world.remove(8);
        SoftObject mat = ball_at({0, 0, 0.105});
        mat.shape = SoftShape::kBox;
        mat.size_m = {1.2, 0.9, 0.2};
        mat.spacing_m = fall.spacing_m;
        mat.mass_kg = 8.6;
        mat.stiffness = fall.stiffness;
        ASSERT_EQ(stage.world.add_soft(mat), AddResult::kAdded);
        RigidObject box{.id = 8, .size_m = {0.4, 0.3, 0.15}, .mass_kg = fall.mass_kg};
        box.world_from_object.translation.z() = 0.275 + fall.height_m;
        ASSERT_EQ(stage.world.add(box), AddResult::kAdded);
        const auto bottom_m = [&] {
            return stage.rigid(8).world_from_object.translation.z() - 0.075;
        };
        double lowest_m = 9.0, rebound_m = 0.0;
        stage.run(6.0, [&] {
            if (bottom_m() < lowest_m) lowest_m = rebound_m = bottom_m();
            rebound_m = std::max(rebound_m, bottom_m());
        });
        EXPECT_LT(rebound_m - 0.2, 0.25 * fall.height_m);
        const geometry::RigidTransform pose = stage.rigid(8).world_from_object;
        EXPECT_GT((pose.rotation * Eigen::Vector3d::UnitZ()).z(), std::cos(0.1));
        EXPECT_LT(pose.translation.head<2>().norm(), 0.1);
        EXPECT_NEAR(bottom_m(), 0.18, 0.03) << "on the mat, not in it";
        int num_above = 0;
        for (const Eigen::Vector3f& node : stage.soft().positions) {
            const Eigen::Vector3d at = pose.inverse() * node.cast<double>();
            num_above += std::abs(at.x()) < 0.19 && std::abs(at.y()) < 0.14 && at.z() > 0.0 ? 1 : 0;
        }
        EXPECT_EQ(num_above, 0);
    }
}

TEST_F(SoftRest, LightThingsUnderACloth) {
    for (const ObjectShape shape : {ObjectShape::kBox, ObjectShape::kCylinder}) {
        for (const double size_m : {0.1, 0.2}) {
            SCOPED_TRACE(size_m);
            stage.world.remove(8);
            stage.world.remove(kSoft);
            RigidObject thing{.id = 8, .shape = shape, .mass_kg = 0.2};
            thing.size_m.setConstant(size_m);
            thing.world_from_object.translation.z() = size_m / 2.0;
            ASSERT_EQ(stage.world.add(thing), AddResult::kAdded);
            ASSERT_EQ(stage.world.add_soft(tablecloth_at({0, 0, size_m + 0.05})),
                      AddResult::kAdded);
            stage.run(10.0);
            EXPECT_LT(
                (stage.rigid(8).world_from_object.translation - thing.world_from_object.translation)
                    .norm(),
                0.02);
            EXPECT_TRUE(sleeps(8));
        }
    }
}

// A curtain that hangs against a box at rest wakes it when it swings.
TEST_F(SoftRest, EndsWhenTheClothSwings) {
    ASSERT_EQ(
        stage.world.add({.id = 8,
                         .size_m = {0.2, 0.2, 0.4},
                         .mass_kg = 0.5,
                         .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0.11, 0.2}}}),
        AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(curtain_at({0, 0, 1.1})), AddResult::kAdded);
    stage.run(15.0);
    const Eigen::Vector3d before = stage.rigid(8).world_from_object.translation;
    ASSERT_TRUE(sleeps(8));
    ASSERT_TRUE(stage.world.push(kSoft, {0, 1.0, 0}));
    stage.run(1.0);
    EXPECT_GT((stage.rigid(8).world_from_object.translation - before).norm(), 0.02);
}

TEST_F(SoftRest, BoxOnAClothOnATable) {
    ASSERT_EQ(stage.world.add(table()), AddResult::kAdded);
    ASSERT_EQ(stage.world.add_soft(tablecloth_at({-0.2, 0.0, 0.75})), AddResult::kAdded);
    for (const double mass_kg : {0.1, 2.0}) {
        stage.world.remove(8);
        RigidObject box{.id = 8, .size_m = {0.2, 0.2, 0.1}, .mass_kg = mass_kg};
        box.world_from_object.translation = {-0.2, 0.0, 0.82};
        ASSERT_EQ(stage.world.add(box), AddResult::kAdded);
        stage.run(10.0);
        const Eigen::Vector3d place = stage.rigid(8).world_from_object.translation;
        EXPECT_NEAR(place.z(), 0.8, 0.003) << mass_kg;
        EXPECT_LT((place - Eigen::Vector3d(-0.2, 0.0, place.z())).norm(), 0.06) << mass_kg;
        EXPECT_TRUE(sleeps(8)) << mass_kg;
        EXPECT_LT(stage.fastest_mps(), 0.005) << mass_kg;
    }
}

TEST_F(SoftRest, BoxInAHammock) {
    SoftObject hammock = tablecloth_at({0.0, 0.0, 0.8});
    hammock.pins = {{PinPlace::kLeft}, {PinPlace::kRight}};
    ASSERT_EQ(stage.world.add_soft(hammock), AddResult::kAdded);
    RigidObject box{.id = 8, .size_m = {0.2, 0.2, 0.1}, .mass_kg = 0.3};
    box.world_from_object.translation.z() = 0.87;
    ASSERT_EQ(stage.world.add(box), AddResult::kAdded);
    stage.run(10.0);
    const Eigen::Vector3d place = stage.rigid(8).world_from_object.translation;
    EXPECT_LT(place.head<2>().norm(), 0.02);
    EXPECT_NEAR(place.z(), 0.8, 0.05);
    EXPECT_TRUE(sleeps(8));
}

// A board on a soft box, asleep.
class BoardOnASoftBox : public SoftRest {
protected:
    static constexpr std::uint32_t kBoard = 8;
    BoardOnASoftBox() {
        SoftObject box = ball_at({0, 0, 0.1});
        box.shape = SoftShape::kBox;
        box.size_m = {0.5, 0.5, 0.2};
        box.spacing_m = 0.05;
        box.stiffness = 1.0;
        box.mass_kg = 2.0;
        stage.world.add_soft(box);
        stage.world.add({.id = kBoard,
                         .size_m = {0.2, 0.2, 0.03},
                         .mass_kg = 0.2,
                         .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 0.24}}});
        stage.run(20.0);
    }
    double height_m() { return stage.rigid(kBoard).world_from_object.translation.z(); }
};

TEST_F(BoardOnASoftBox, FallsWhenTheBoxIsThrownAway) {
    ASSERT_TRUE(sleeps(kBoard));
    ASSERT_GT(height_m(), 0.15);
    stage.throw_soft(kSoft, {6, 0, -1});
    stage.run(2.0);
    EXPECT_NEAR(height_m(), 0.015, 0.003);
}

TEST_F(BoardOnASoftBox, FallsWhenABallKnocksTheBoxAway) {
    ASSERT_TRUE(sleeps(kBoard));
    RigidObject ball{.id = 9, .shape = ObjectShape::kSphere, .size_m = {0.2, 0.2, 0.2}};
    ball.mass_kg = 20.0;
    ball.world_from_object.translation = {-0.4, 0, 0.1};
    ASSERT_EQ(stage.world.add(ball), AddResult::kAdded);
    RigidState state = stage.rigid(9);
    state.linear_velocity = {10, 0, 0};
    ASSERT_TRUE(stage.world.set_state(state));
    stage.run(2.0);
    EXPECT_NEAR(height_m(), 0.015, 0.003);
}

TEST_F(BoardOnASoftBox, WakesWhenAViewerPullsAtTheBox) {
    ASSERT_TRUE(sleeps(kBoard));
    ASSERT_TRUE(stage.world.grab("viewer", kSoft, {0.15, 0, 0.1}, {0.15, 0, 0.1}));
    stage.run(0.1);
    ASSERT_TRUE(stage.world.move_grab("viewer", kSoft, {1.0, 0, 0.1}));
    stage.run(2.0);
    EXPECT_GT(stage.rigid(kBoard).world_from_object.translation.head<2>().norm(), 0.02);
}

}  // namespace
}  // namespace atrium::physics
