#include "ticks.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>

namespace atrium::physics {
namespace {

const Eigen::Vector3d kCentre = Eigen::Vector3d::Zero();

// A floor and a box of 20 cm on it.
struct Room {
    explicit Room(double mass_kg = 2.0) {
        world.add({.id = 1, .shape = ObjectShape::kPlane});
        world.add({.id = 2,
                   .shape = ObjectShape::kBox,
                   .size_m = {0.2, 0.2, 0.2},
                   .mass_kg = mass_kg,
                   .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 0.1}}});
    }
    RigidState box() const {
        std::vector<RigidState> states;
        world.get_states(states);
        return states.at(1);
    }
    Eigen::Vector3d place() const { return box().world_from_object.translation; }
    void run(double seconds) {
        for (int i = 0; i < static_cast<int>(seconds / kTickS + 0.5); ++i) world.tick();
    }
    World world{{}};
};

TEST(Grab, MovesTheHeldPointToItsGoalAndKeepsItThere) {
    for (const double mass_kg : {0.05, 2.0, 30.0}) {
        Room room(mass_kg);
        const Eigen::Vector3d point(0.1, 0.1, 0.1);
        const Eigen::Vector3d goal(0.8, -0.5, 1.2);
        ASSERT_TRUE(room.world.grab("eve", 2, point, goal));
        room.run(1.5);
        EXPECT_LT((room.box().world_from_object * point - goal).norm(), 0.02) << mass_kg;
        EXPECT_EQ(room.world.num_grabs(), 1U);
    }
}

TEST(Grab, HasBoundedForce) {
    Room heavy(150.0);
    ASSERT_TRUE(heavy.world.grab("eve", 2, kCentre, {0, 0, 2}));
    heavy.run(1.0);
    EXPECT_LT(heavy.place().z(), 0.11) << "150 kg are more than 500 N can lift";

    Room light(0.5);
    ASSERT_TRUE(light.world.grab("eve", 2, kCentre, {0, 0, -5}));
    light.run(1.0);
    EXPECT_GT(light.place().z(), 0.09) << "not through the floor";
    EXPECT_LT(light.place().z(), 0.11);
}

TEST(Grab, ThrowsAnObjectReleasedInMotion) {
    Room room;
    Eigen::Vector3d goal(0, 0, 1);
    ASSERT_TRUE(room.world.grab("eve", 2, kCentre, goal));
    room.run(0.5);
    for (int i = 0; i < 36; ++i) {  // 3 m/s for 0.3 s
        goal.x() += 3.0 * kTickS;
        ASSERT_TRUE(room.world.move_grab("eve", 2, goal));
        room.world.tick();
    }
    ASSERT_TRUE(room.world.release("eve", 2));
    EXPECT_FALSE(room.world.release("eve", 2));
    const double before_m = room.place().x();
    room.run(0.2);
    EXPECT_NEAR(room.place().x() - before_m, 0.6, 0.08);
    EXPECT_LT(room.box().linear_velocity.norm(), 15.0);
}

TEST(Grab, EndsAfterTwoSecondsWithoutAnUpdate) {
    Room room;
    ASSERT_TRUE(room.world.grab("eve", 2, kCentre, {0, 0, 1}));
    room.run(1.9);
    ASSERT_TRUE(room.world.move_grab("eve", 2, {0, 0, 1}));
    room.run(1.95);
    EXPECT_EQ(room.world.num_grabs(), 1U);
    EXPECT_NEAR(room.place().z(), 1.0, 0.02);
    room.run(0.1);
    EXPECT_EQ(room.world.num_grabs(), 0U);
    EXPECT_FALSE(room.world.move_grab("eve", 2, {0, 0, 1}));
    room.run(1.5);
    EXPECT_NEAR(room.place().z(), 0.1, 0.01) << "it fell";
}

TEST(Grab, EndsWithItsHolderAndItsObject) {
    Room room;
    ASSERT_TRUE(room.world.grab("eve", 2, kCentre, {0, 0, 1}));
    ASSERT_TRUE(room.world.grab("bob", 2, kCentre, {0, 0, 1}));
    EXPECT_EQ(room.world.num_grabs(), 2U);
    room.world.release_all("eve");
    EXPECT_EQ(room.world.num_grabs(), 1U);
    ASSERT_TRUE(room.world.remove(2));
    EXPECT_EQ(room.world.num_grabs(), 0U);
    room.run(0.1);
}

TEST(Grab, OfTwoHoldersSettlesInTheMiddle) {
    Room room;
    ASSERT_TRUE(room.world.grab("eve", 2, kCentre, {-0.5, 0, 1}));
    ASSERT_TRUE(room.world.grab("bob", 2, kCentre, {0.5, 0, 1}));
    room.run(1.5);
    EXPECT_NEAR(room.place().z(), 1.0, 0.05);
    EXPECT_LT(std::abs(room.place().x()), 0.45);
    EXPECT_LT(room.box().linear_velocity.norm(), 0.2) << "the box must not tremble";
}

TEST(Grab, RefusesInvalidArguments) {
    Room room;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(room.world.grab("eve", 1, kCentre, kCentre)) << "the floor";
    EXPECT_FALSE(room.world.grab("eve", 7, kCentre, kCentre)) << "nobody";
    EXPECT_FALSE(room.world.grab("eve", 2, {nan, 0, 0}, kCentre));
    EXPECT_FALSE(room.world.grab("eve", 2, kCentre, {0, nan, 0}));
    EXPECT_FALSE(room.world.move_grab("eve", 2, kCentre));
    ASSERT_TRUE(room.world.grab("eve", 2, kCentre, kCentre));
    EXPECT_FALSE(room.world.move_grab("eve", 2, {0, 0, nan}));
    for (std::uint32_t id = 10; id < 14; ++id) {
        room.world.add({.id = id,
                        .shape = ObjectShape::kSphere,
                        .size_m = {0.1, 0.1, 0.1},
                        .mass_kg = 0.2,
                        .world_from_object = {Eigen::Quaterniond::Identity(), {id * 1.0, 0, 1}}});
        EXPECT_EQ(room.world.grab("eve", id, kCentre, {0, 0, 1}), id < 13)
            << "only four grabs are allowed";
    }
}

}  // namespace
}  // namespace atrium::physics
