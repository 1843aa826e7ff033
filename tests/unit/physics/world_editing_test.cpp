#include "things.hpp"
#include "world_server/physics/state/world_state.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>

namespace atrium::physics {
namespace {

constexpr std::uint32_t kHeld = 2;
constexpr std::uint32_t kOther = 3;

geometry::RigidTransform pose_at(const Eigen::Vector3d& position, double yaw_rad = 0.0) {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), position};
}

struct EditedRoom {
    EditedRoom() {
        world.add(floor_plane());
        world.add(box_at(kHeld, {0, 0, 0.1}));
        world.add(box_at(kOther, {0.8, 0, 0.1}));
    }
    World world{{}};
};

TEST(Hold, CarriesAnObjectAgainstGravityAndContactsAndLeavesItAtRest) {
    EditedRoom room;
    const auto goal = pose_at({0.2, 0.3, 1.4}, 1.0);
    ASSERT_EQ(room.world.hold("eve", kHeld, goal), HoldResult::kHeld);
    run(room.world, 1.0);
    const RigidState held = state_of(room.world, kHeld);
    EXPECT_LT((held.world_from_object.translation - goal.translation).norm(), 1e-3);
    EXPECT_LT(held.world_from_object.rotation.angularDistance(goal.rotation), 1e-2);
    // through the place of another object, which must give way
    ASSERT_EQ(room.world.hold("eve", kHeld, pose_at({0, 0, 0.1})), HoldResult::kHeld);
    run(room.world, 1.0);
    ASSERT_EQ(room.world.hold("eve", kHeld, pose_at({0.9, 0, 0.1})), HoldResult::kHeld);
    run(room.world, 1.0);
    EXPECT_NEAR(state_of(room.world, kHeld).world_from_object.translation.x(), 0.9, 1e-3);
    EXPECT_GT(state_of(room.world, kOther).world_from_object.translation.x(), 1.05);
    EXPECT_TRUE(room.world.let_go("eve", kHeld));
    room.world.tick();
    EXPECT_LT(state_of(room.world, kHeld).linear_velocity.norm(), 0.2) << "at most a tick of fall";
}

TEST(Hold, HasOneHolderAndEndsWithItsMessages) {
    EditedRoom room;
    const auto up = pose_at({0, 0, 1.0});
    ASSERT_EQ(room.world.hold("eve", kHeld, up), HoldResult::kHeld);
    EXPECT_EQ(room.world.hold("bob", kHeld, up), HoldResult::kHeldByOther);
    EXPECT_EQ(room.world.hold("bob", 99, up), HoldResult::kUnknownObject);
    EXPECT_EQ(room.world.holder_of(kHeld), "eve");
    EXPECT_FALSE(room.world.let_go("bob", kHeld));
    run(room.world, 1.9);
    EXPECT_NEAR(state_of(room.world, kHeld).world_from_object.translation.z(), 1.0, 1e-3);
    run(room.world, 1.1);  // 2 s without a message
    EXPECT_EQ(room.world.holder_of(kHeld), "");
    EXPECT_LT(state_of(room.world, kHeld).world_from_object.translation.z(), 0.12);
    EXPECT_EQ(room.world.hold("bob", kHeld, up), HoldResult::kHeld);
    room.world.release_all("bob");
    EXPECT_EQ(room.world.holder_of(kHeld), "");
}

TEST(Hold, MovesAFixedObjectAndWakesWhatLiesOnIt) {
    EditedRoom room;
    RigidObject shelf = box_at(4, {0, 2, 0.5}, {0.6, 0.6, 0.05});
    shelf.mass_kg = 0.0;
    ASSERT_EQ(room.world.add(shelf), AddResult::kAdded);
    ASSERT_EQ(room.world.add(box_at(5, {0, 2, 0.63})), AddResult::kAdded);
    run(room.world, 4.0);  // asleep by now
    ASSERT_EQ(room.world.hold("eve", 4, pose_at({2, 2, 0.5})), HoldResult::kHeld);
    run(room.world, 1.5);
    EXPECT_NEAR(state_of(room.world, 4).world_from_object.translation.x(), 2.0, 1e-3);
    EXPECT_LT(state_of(room.world, 5).world_from_object.translation.z(), 0.2) << "it fell";
}

TEST(Place, WakesWhatLayOnTheObjectAndNothingElsewhere) {
    EditedRoom room;
    constexpr std::uint32_t kOnTop = 4;
    room.world.add(box_at(kOnTop, {0, 0, 0.3}));
    run(room.world, 5.0);
    const auto sleeps = [&](std::uint32_t id) {
        constexpr int kAsleep = 2;  // ISLAND_SLEEPING of Bullet
        WorldState state;
        room.world.get_state(state);
        const auto found = std::ranges::find(state.objects, id, &ObjectMotion::id);
        return found->activation == kAsleep;
    };
    ASSERT_TRUE(sleeps(kHeld) && sleeps(kOnTop) && sleeps(kOther));
    ASSERT_TRUE(room.world.place(kHeld, pose_at({-1.5, 0, 0.1})));
    run(room.world, 1.0);
    EXPECT_TRUE(sleeps(kOther));
    EXPECT_NEAR(state_of(room.world, kOnTop).world_from_object.translation.z(), 0.1, 0.005);
    // and what lies where it comes to
    run(room.world, 5.0);
    ASSERT_TRUE(sleeps(kOnTop));
    ASSERT_TRUE(room.world.place(kHeld, pose_at({0.1, 0, 0.1})));
    run(room.world, 0.1);
    EXPECT_FALSE(sleeps(kOnTop));
    EXPECT_TRUE(sleeps(kOther));
}

TEST(Change, KeepsPoseAndMotionAndAppliesAtOnce) {
    EditedRoom room;
    ASSERT_TRUE(room.world.set_state(
        {.id = kHeld, .world_from_object = pose_at({0, 0, 1}), .linear_velocity = {0.5, 0, 0}}));
    RigidObject changed = *room.world.object(kHeld);
    changed.mass_kg *= 3.0;
    changed.restitution = 0.0;
    ASSERT_TRUE(room.world.change(changed));
    EXPECT_NEAR(state_of(room.world, kHeld).linear_velocity.x(), 0.5, 1e-6);
    // an impulse now gives a third of the velocity
    ASSERT_TRUE(room.world.push(kHeld, {changed.mass_kg, 0, 0}));
    EXPECT_NEAR(state_of(room.world, kHeld).linear_velocity.x(), 1.5, 1e-5);

    changed.mass_kg = 0.0;
    ASSERT_TRUE(room.world.change(changed));
    run(room.world, 0.5);
    EXPECT_NEAR(state_of(room.world, kHeld).world_from_object.translation.z(), 1.0, 1e-6);
    changed.mass_kg = 2.0;
    changed.size_m = {0.4, 0.4, 0.4};
    ASSERT_TRUE(room.world.change(changed));
    run(room.world, 2.0);
    EXPECT_NEAR(state_of(room.world, kHeld).world_from_object.translation.z(), 0.2, 0.01)
        << "it falls, and is as large as it should be";
    changed.size_m.setZero();
    EXPECT_FALSE(room.world.change(changed));
}

TEST(Change, RefusesAnotherBodyForAJoinedObject) {
    EditedRoom room;
    ASSERT_TRUE(room.world.add_joint({.kind = JointKind::kBall, .a = kHeld, .b = kOther}));
    EXPECT_TRUE(room.world.is_joined(kHeld));
    RigidObject changed = *room.world.object(kHeld);
    changed.friction = 0.9;
    EXPECT_TRUE(room.world.change(changed));
    changed.mass_kg = 0.0;
    EXPECT_FALSE(room.world.change(changed));
    EXPECT_EQ(room.world.num_joints(), 1U);
}

}  // namespace
}  // namespace atrium::physics
