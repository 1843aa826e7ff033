#include "tests/unit/physics/things.hpp"

#include <gmock/gmock.h>

namespace atrium::physics {
namespace {

WorldOptions room(LeavePolicy leaving) {
    return {.box = geometry::Aabb{.min = {-1, -1, -0.5}, .max = {1, 1, 2}}, .leaving = leaving};
}

std::vector<Incident> incidents_of(World& world) {
    std::vector<Incident> incidents;
    world.take_incidents(incidents);
    return incidents;
}

// A box that moves out along +x, with a second box that hangs below it.
void throw_two_out(World& world) {
    ASSERT_EQ(world.add(floor_plane()), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(2, {0, 0, 1.5}, {0.1, 0.1, 0.1})), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(3, {0, 0, 1.3}, {0.1, 0.1, 0.1})), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(4, {0, 0.8, 0.05}, {0.1, 0.1, 0.1})), AddResult::kAdded);
    ASSERT_TRUE(world.add_joint({.a = 3, .b = 2, .anchor_m = {0, 0, 1.4}}));
    for (const std::uint32_t id : {2U, 3U}) ASSERT_TRUE(world.push(id, {4.0 * 0.5, 0, 0}));
}

TEST(Bounds, ResetReturnsAnEscapedObjectWithItsJointPartners) {
    World world(room(LeavePolicy::kReset));
    throw_two_out(world);
    while (world.counters().num_strays == 0 && world.counters().num_ticks < 120) world.tick();
    EXPECT_EQ(world.counters().num_strays, 1U);
    for (const std::uint32_t id : {2U, 3U}) {
        const RigidState state = state_of(world, id);
        EXPECT_NEAR(state.world_from_object.translation.x(), 0.0, 1e-6) << id;
        EXPECT_EQ(state.linear_velocity, Eigen::Vector3d::Zero()) << id;
    }
    const auto incidents = incidents_of(world);
    ASSERT_EQ(incidents.size(), 1U);
    EXPECT_EQ(incidents[0].kind, IncidentKind::kLeft);
    EXPECT_EQ(world.num_objects(), 4U);
}

TEST(Bounds, RemoveDropsAnEscapedObjectWithItsJointPartners) {
    World world(room(LeavePolicy::kRemove));
    throw_two_out(world);
    run(world, 1.0);
    EXPECT_EQ(world.num_objects(), 2U) << "the floor and the other box must remain";
    EXPECT_EQ(world.num_joints(), 0U);
    std::vector<std::uint32_t> removed;
    for (const Incident& incident : incidents_of(world)) {
        EXPECT_EQ(incident.kind, IncidentKind::kRemoved);
        removed.push_back(incident.object);
    }
    EXPECT_THAT(removed, testing::UnorderedElementsAre(2U, 3U));
}

double speed_after_wall(double restitution) {
    WorldOptions options = room(LeavePolicy::kBounce);
    options.gravity.setZero();
    options.wall_restitution = restitution;
    World world(options);
    RigidObject box = box_at(2, {0, 0, 1}, {0.1, 0.1, 0.1});
    box.restitution = 1.0;
    EXPECT_EQ(world.add(box), AddResult::kAdded);
    EXPECT_TRUE(world.push(2, {2.0 * box.mass_kg, 0, 0}));
    run(world, 1.0);
    return state_of(world, 2).linear_velocity.x();
}

TEST(Bounds, AnOptionSetsTheBounceOfTheWalls) {
    EXPECT_LT(speed_after_wall(0.9), -1.5);
    EXPECT_NEAR(speed_after_wall(0.0), 0.0, 0.1);
}

TEST(Bounds, BounceKeepsEverythingInside) {
    World world(room(LeavePolicy::kBounce));
    throw_two_out(world);
    for (int i = 0; i < 600; ++i) {
        world.tick();
        for (const std::uint32_t id : {2U, 3U, 4U})
            EXPECT_LT(state_of(world, id).world_from_object.translation.cwiseAbs().maxCoeff(), 2.0);
        EXPECT_LT(state_of(world, 2).world_from_object.translation.x(), 1.0);
    }
    EXPECT_EQ(world.counters().num_strays, 0U);
    EXPECT_TRUE(incidents_of(world).empty());
}

TEST(Guards, NonFiniteStateResetsOnlyThatObject) {
    World world({});
    ASSERT_EQ(world.add(floor_plane()), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(2, {0, 0, 0.1})), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(3, {1, 0, 1.0})), AddResult::kAdded);
    ASSERT_TRUE(world.push(2, {1e300, 0, 0}));  // infinite in single precision
    for (int i = 0; i < 12; ++i) world.tick();
    const auto incidents = incidents_of(world);
    ASSERT_EQ(incidents.size(), 1U);
    EXPECT_EQ(incidents[0].object, 2U);
    EXPECT_EQ(incidents[0].kind, IncidentKind::kNotFinite);
    EXPECT_EQ(world.counters().num_not_finite, 1U);
    EXPECT_NEAR(state_of(world, 2).world_from_object.translation.x(), 0.0, 0.01);
    EXPECT_LT(state_of(world, 3).linear_velocity.z(), -0.5) << "the other object must keep falling";
}

TEST(Guards, AbsurdSpeedResetsAndHighSpeedIsLimited) {
    World world({.gravity = Eigen::Vector3d::Zero()});
    ASSERT_EQ(world.add(box_at(2, {0, 0, 1})), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(3, {0, 2, 1})), AddResult::kAdded);
    ASSERT_TRUE(world.push(2, {4.0 * 200.0, 0, 0}));
    ASSERT_TRUE(world.push(3, {4.0 * 40.0, 0, 0}));
    world.tick();
    EXPECT_EQ(world.counters().num_runaways, 1U);
    EXPECT_EQ(state_of(world, 2).linear_velocity.norm(), 0.0);
    EXPECT_NEAR(state_of(world, 3).linear_velocity.x(), 15.0, 1e-3);
    const auto incidents = incidents_of(world);
    ASSERT_EQ(incidents.size(), 1U);
    EXPECT_EQ(incidents[0].object, 2U);
    EXPECT_EQ(incidents[0].kind, IncidentKind::kRunaway);
}

}  // namespace
}  // namespace atrium::physics
