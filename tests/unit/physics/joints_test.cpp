#include "tests/unit/physics/things.hpp"

#include <numbers>

namespace atrium::physics {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// A bar of 40 cm that hangs to +x from the world at the origin, 2 m up.
struct Bar {
    RigidObject object = box_at(2, {0.2, 0, 2}, {0.4, 0.05, 0.05});
    Eigen::Vector3d anchor{0, 0, 2};
    World world{{}};
    Bar() { EXPECT_EQ(world.add(object), AddResult::kAdded); }
    double gap() const { return (now_at(world, object, anchor) - anchor).norm(); }
};

TEST(Joints, HingeKeepsItsAnchorAndPlaneUnderLoad) {
    Bar bar;
    ASSERT_TRUE(bar.world.add_joint({.kind = JointKind::kHinge,
                                     .a = 2,
                                     .anchor_m = bar.anchor,
                                     .axis = Eigen::Vector3d::UnitY()}));
    ASSERT_TRUE(bar.world.push(2, {0, 5, 0})) << "along the axis, which resists";
    double lowest = 2.0;
    for (int i = 0; i < 600; ++i) {
        bar.world.tick();
        const RigidState state = state_of(bar.world, 2);
        lowest = std::min(lowest, state.world_from_object.translation.z());
        EXPECT_LT(bar.gap(), 0.01);
        EXPECT_LT(std::abs(state.world_from_object.translation.y()), 0.01);
    }
    EXPECT_LT(lowest, 1.82) << "the bar must swing through the bottom";
}

TEST(Joints, HingeStopsAtItsLimitsWithoutBouncing) {
    for (const double limit_deg : {30.0, 60.0}) {
        Bar bar;
        // right-handed about -y: +x turns up, and gravity turns it down to the lower limit
        ASSERT_TRUE(bar.world.add_joint({.kind = JointKind::kHinge,
                                         .a = 2,
                                         .anchor_m = bar.anchor,
                                         .axis = -Eigen::Vector3d::UnitY(),
                                         .limits = {{-limit_deg * kRadPerDeg, 100 * kRadPerDeg}}}));
        double steepest_deg = 0.0;
        for (int i = 0; i < 480; ++i) {
            bar.world.tick();
            const Eigen::Vector3d along =
                state_of(bar.world, 2).world_from_object.rotation * Eigen::Vector3d::UnitX();
            steepest_deg = std::max(steepest_deg, std::asin(-along.z()) / kRadPerDeg);
        }
        const Eigen::Vector3d along =
            state_of(bar.world, 2).world_from_object.rotation * Eigen::Vector3d::UnitX();
        EXPECT_NEAR(std::asin(-along.z()) / kRadPerDeg, limit_deg, 1.5);
        EXPECT_LT(steepest_deg, limit_deg + 8.0);
        EXPECT_LT(state_of(bar.world, 2).angular_velocity.norm(), 0.05);
    }
}

TEST(Joints, HingeMotorTurnsAtItsSpeedInTheRightDirection) {
    Bar bar;
    ASSERT_TRUE(bar.world.add_joint({.kind = JointKind::kHinge,
                                     .a = 2,
                                     .anchor_m = bar.anchor,
                                     .axis = Eigen::Vector3d::UnitZ(),
                                     .motor_speed = 3.0,
                                     .motor_max = 50.0}));
    run(bar.world, 1.0);
    EXPECT_NEAR(state_of(bar.world, 2).angular_velocity.z(), 3.0, 0.15);
}

TEST(Joints, AChainOfBallsCarriesTwoHundredTimesTheMassOfALink) {
    World world({});
    constexpr std::uint32_t kNumLinks = 3;
    for (std::uint32_t i = 0; i <= kNumLinks; ++i) {
        const bool is_weight = i == kNumLinks;
        RigidObject link = box_at(2 + i, {0, 0, 3.85 - 0.3 * i});
        link.shape = is_weight ? ObjectShape::kSphere : ObjectShape::kCapsule;
        link.size_m = is_weight ? Eigen::Vector3d(0.3, 0.3, 0.3) : Eigen::Vector3d(0.03, 0.03, 0.3);
        link.mass_kg = is_weight ? 20.0 : 0.1;
        ASSERT_EQ(world.add(link), AddResult::kAdded);
        ASSERT_TRUE(world.add_joint({.kind = JointKind::kBall,
                                     .a = 2 + i,
                                     .b = i == 0 ? 0 : 1 + i,
                                     .anchor_m = {0, 0, 4.0 - 0.3 * i}}));
    }
    for (int second = 0; second < 10; ++second) {
        if (second == 5) world.push(2 + kNumLinks, {10, 0, 0});
        run(world, 1.0);
        const double length_m = (state_of(world, 2 + kNumLinks).world_from_object.translation -
                                 Eigen::Vector3d(0, 0, 4))
                                    .norm();
        EXPECT_NEAR(length_m, 1.05, 0.01) << second;
    }
    EXPECT_EQ(world.counters().num_torn, 0);
}

TEST(Joints, BallJointKeepsItsAnchorConeAndTwist) {
    Bar bar;
    ASSERT_TRUE(bar.world.add_joint({.kind = JointKind::kBall,
                                     .a = 2,
                                     .anchor_m = bar.anchor,
                                     .axis = Eigen::Vector3d::UnitX(),
                                     .swing_rad = 40 * kRadPerDeg,
                                     .twist_rad = 10 * kRadPerDeg,
                                     .damping = 0.02}));
    ASSERT_TRUE(bar.world.push(2, {0, 0.5, 0}));
    for (int i = 0; i < 600; ++i) {
        bar.world.tick();
        EXPECT_LT(bar.gap(), 0.01);
    }
    const Eigen::Vector3d along =
        state_of(bar.world, 2).world_from_object.rotation * Eigen::Vector3d::UnitX();
    EXPECT_NEAR(std::asin(-along.z()) / kRadPerDeg, 40.0, 2.0);
    EXPECT_LT(state_of(bar.world, 2).angular_velocity.norm(), 0.1);
}

TEST(Joints, FreeBallJointHangsDown) {
    Bar bar;
    ASSERT_TRUE(bar.world.add_joint(
        {.kind = JointKind::kBall, .a = 2, .anchor_m = bar.anchor, .damping = 0.1}));
    run(bar.world, 10.0);
    const RigidState state = state_of(bar.world, 2);
    EXPECT_LT((state.world_from_object.translation - Eigen::Vector3d(0, 0, 1.8)).norm(), 0.01);
}

TEST(Joints, SliderMovesBetweenItsLimitsWithoutTurning) {
    World world({});
    const RigidObject box = box_at(2, {0, 0, 2});
    ASSERT_EQ(world.add(box), AddResult::kAdded);
    const Eigen::Vector3d axis = Eigen::Vector3d(1, 0, 1).normalized();
    ASSERT_TRUE(world.add_joint({.kind = JointKind::kSlider,
                                 .a = 2,
                                 .anchor_m = {0, 0, 2},
                                 .axis = axis,
                                 .limits = {{-0.5, 0.2}}}));
    ASSERT_TRUE(world.push(2, {0, 3, 0}));
    run(world, 3.0);
    const RigidState down = state_of(world, 2);
    const Eigen::Vector3d moved = down.world_from_object.translation - Eigen::Vector3d(0, 0, 2);
    EXPECT_NEAR(moved.dot(axis), -0.5, 0.01);
    EXPECT_LT((moved - axis * axis.dot(moved)).norm(), 0.01);
    EXPECT_LT(down.world_from_object.rotation.angularDistance(Eigen::Quaterniond::Identity()),
              0.01);

    // a motor lifts it to the other end
    World lift({});
    ASSERT_EQ(lift.add(box), AddResult::kAdded);
    ASSERT_TRUE(lift.add_joint({.kind = JointKind::kSlider,
                                .a = 2,
                                .anchor_m = {0, 0, 2},
                                .axis = axis,
                                .limits = {{-0.5, 0.2}},
                                .motor_speed = 0.3,
                                .motor_max = 200.0}));
    run(lift, 2.0);
    const Eigen::Vector3d lifted =
        state_of(lift, 2).world_from_object.translation - Eigen::Vector3d(0, 0, 2);
    EXPECT_NEAR(lifted.dot(axis), 0.2, 0.01);
}

TEST(Joints, SpringHoldsAWeightByHookesLaw) {
    World world({});
    const RigidObject box = box_at(2, {0, 0, 1});  // 4 kg
    ASSERT_EQ(world.add(box), AddResult::kAdded);
    ASSERT_TRUE(world.add_joint({.kind = JointKind::kSpring,
                                 .a = 2,
                                 .anchor_m = {0, 0, 1},
                                 .damping = 20.0,
                                 .stiffness_npm = 200.0,
                                 .rest_length_m = 0.5,
                                 .anchor_b_m = {0, 0, 2}}));
    run(world, 6.0);
    EXPECT_NEAR(state_of(world, 2).world_from_object.translation.z(),
                2.0 - 0.5 - box.mass_kg * 9.81 / 200.0,
                0.005);
}

TEST(Joints, SpringTooStiffForTheStepIsStable) {
    World world({});
    const RigidObject box = box_at(2, {0, 0, 1}, {0.05, 0.05, 0.05});  // 62 g
    ASSERT_EQ(world.add(box), AddResult::kAdded);
    ASSERT_TRUE(world.add_joint({.kind = JointKind::kSpring,
                                 .a = 2,
                                 .anchor_m = {0, 0, 1},
                                 .stiffness_npm = 1e6,
                                 .rest_length_m = 0.9,
                                 .anchor_b_m = {0, 0, 2},
                                 .pulls_only = true}));
    for (int i = 0; i < 600; ++i) {
        world.tick();
        ASSERT_LT(state_of(world, 2).linear_velocity.norm(), 15.0);
    }
    EXPECT_NEAR(state_of(world, 2).world_from_object.translation.z(), 1.1, 0.05);
}

TEST(Joints, SpringForceIsBounded) {
    for (const bool is_stretched : {true, false}) {
        World world({.gravity = Eigen::Vector3d::Zero()});
        const RigidObject box = box_at(2, {0, 0, 1});  // 4 kg
        ASSERT_EQ(world.add(box), AddResult::kAdded);
        ASSERT_TRUE(world.add_joint({.kind = JointKind::kSpring,
                                     .a = 2,
                                     .anchor_m = {0, 0, 1},
                                     .stiffness_npm = 5000.0,
                                     .rest_length_m = is_stretched ? 0.2 : 1.8,
                                     .force_max = 10.0,
                                     .anchor_b_m = {0, 0, 2}}));
        run(world, 0.25);
        const double speed = state_of(world, 2).linear_velocity.z();
        EXPECT_NEAR(speed * (is_stretched ? 1.0 : -1.0), 10.0 / box.mass_kg * 0.25, 0.01);
        // within its bound it acts as the unbounded spring
        for (int i = 0; i < 1200; ++i) {
            world.tick();
            ASSERT_LT(state_of(world, 2).linear_velocity.norm(), 2.1);  // 10 N over 0.8 m
        }
    }
}

TEST(Joints, StringPullsAndDoesNotPush) {
    World world({});
    ASSERT_EQ(world.add(floor_plane()), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(2, {0, 0, 0.1})), AddResult::kAdded);
    ASSERT_TRUE(world.add_joint({.kind = JointKind::kSpring,
                                 .a = 2,
                                 .anchor_m = {0, 0, 0.1},
                                 .stiffness_npm = 5000.0,
                                 .rest_length_m = 1.0,
                                 .anchor_b_m = {0, 0, 0.6},
                                 .pulls_only = true}));
    run(world, 2.0);
    EXPECT_NEAR(state_of(world, 2).world_from_object.translation.z(), 0.1, 0.005);
    EXPECT_LT(state_of(world, 2).linear_velocity.norm(), 0.02);
}

TEST(Joints, JoinedObjectsCollideOnlyOnRequest) {
    for (const bool collides : {false, true}) {
        World world({.gravity = Eigen::Vector3d::Zero()});
        ASSERT_EQ(world.add(box_at(2, {0, 0, 1})), AddResult::kAdded);
        ASSERT_EQ(world.add(box_at(3, {0.15, 0, 1})), AddResult::kAdded);  // they overlap by 5 cm
        ASSERT_TRUE(world.add_joint({.kind = JointKind::kSpring,
                                     .a = 2,
                                     .b = 3,
                                     .anchor_m = {0, 0, 1},
                                     .damping = 10.0,
                                     .anchor_b_m = {0.15, 0, 1},
                                     .collides = collides}));
        run(world, 2.0);
        const double apart = state_of(world, 3).world_from_object.translation.x() -
                             state_of(world, 2).world_from_object.translation.x();
        EXPECT_NEAR(apart, collides ? 0.2 : 0.15, 0.01);
    }
}

TEST(Joints, AreRemovedWithTheirObjects) {
    World world({});
    ASSERT_EQ(world.add(box_at(2, {0, 0, 2})), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(3, {0, 0, 1.7})), AddResult::kAdded);
    ASSERT_TRUE(world.add_joint({.a = 2, .anchor_m = {0, 0, 2.1}}));
    ASSERT_TRUE(world.add_joint({.a = 3, .b = 2, .anchor_m = {0, 0, 1.85}}));
    run(world, 3.0);  // both hang, asleep by now
    EXPECT_GT(state_of(world, 3).world_from_object.translation.z(), 1.65);
    ASSERT_TRUE(world.remove(2));
    EXPECT_EQ(world.num_joints(), 0U);
    run(world, 0.5);
    EXPECT_LT(state_of(world, 3).world_from_object.translation.z(), 0.8)
        << "the other object must fall";
}

TEST(Joints, RefuseInvalidArguments) {
    World world({});
    ASSERT_EQ(world.add(floor_plane()), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(2, {0, 0, 2})), AddResult::kAdded);
    const auto refused = [&](const Joint& joint) { return !world.add_joint(joint); };
    EXPECT_TRUE(refused({.a = 7})) << "nobody";
    EXPECT_TRUE(refused({.a = 2, .b = 7})) << "nobody";
    EXPECT_TRUE(refused({.a = 2, .b = 2})) << "an object joined to itself";
    EXPECT_TRUE(refused({.a = kFloorId})) << "the floor joined to the world";
    EXPECT_TRUE(refused({.a = 2, .anchor_m = {std::nan(""), 0, 0}}));
    EXPECT_TRUE(refused({.a = 2, .axis = {0, 0, 0}}));
    EXPECT_TRUE(refused({.kind = JointKind::kHinge, .a = 2, .limits = {{0.5, 1.0}}}))
        << "a joint that starts outside its limits";
    EXPECT_TRUE(refused({.a = 2, .swing_rad = 2.0}));
    EXPECT_TRUE(refused({.a = 2, .damping = -1.0}));
    EXPECT_EQ(world.num_joints(), 0U);
}

TEST(Joints, TornJointResetsItsObjectsAndIsReported) {
    World world({.gravity = Eigen::Vector3d::Zero()});
    ASSERT_EQ(world.add(box_at(2, {0, 0, 2})), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(3, {0, 0, 1.7})), AddResult::kAdded);
    ASSERT_EQ(world.add(box_at(4, {2, 0, 1.7})), AddResult::kAdded);
    ASSERT_TRUE(world.add_joint({.a = 3, .b = 2, .anchor_m = {0, 0, 1.85}}));
    RigidState far = state_of(world, 3);
    far.world_from_object.translation = {0.4, 0, 1.3};
    ASSERT_TRUE(world.push(4, {1, 0, 0}));
    ASSERT_TRUE(world.set_state(far));
    for (int i = 0; i < 3; ++i) world.tick();
    std::vector<Incident> incidents;
    world.take_incidents(incidents);
    ASSERT_EQ(incidents.size(), 1U);
    EXPECT_EQ(incidents[0].kind, IncidentKind::kTorn);
    EXPECT_EQ(world.counters().num_torn, 1U);
    EXPECT_LT(
        (state_of(world, 3).world_from_object.translation - Eigen::Vector3d(0, 0, 1.7)).norm(),
        0.01);
    EXPECT_GT(state_of(world, 4).linear_velocity.x(), 0.2) << "the rest of the world must continue";
    world.take_incidents(incidents);
    EXPECT_TRUE(incidents.empty());
}

TEST(Joints, RiderOfASeesawSlidesDownAndIsNotLeftHanging) {
    World world{{}};
    world.add(floor_plane());
    RigidObject stand = box_at(2, {0, 0, 0.15}, {0.1, 0.3, 0.3});
    stand.mass_kg = 0.0;
    RigidObject plank = box_at(3, {0, 0, 0.34}, {1.8, 0.25, 0.04});
    plank.mass_kg = 12.6;
    plank.friction = 0.5;
    RigidObject rider = box_at(4, {0.7, 0, 0.44}, {0.15, 0.15, 0.15});
    rider.mass_kg = 0.5;
    rider.friction = 0.5;
    world.add(stand);
    world.add(plank);
    world.add(rider);
    ASSERT_TRUE(world.add_joint({.kind = JointKind::kHinge,
                                 .a = 3,
                                 .b = 2,
                                 .anchor_m = {0, 0, 0.32},
                                 .axis = Eigen::Vector3d::UnitY(),
                                 .limits = {{-20 * kRadPerDeg, 20 * kRadPerDeg}},
                                 .damping = 0.2}));
    run(world, 10.0);
    // 20 degrees are more than wood on cardboard holds
    EXPECT_GT(state_of(world, 4).world_from_object.translation.x(), 0.9);
    EXPECT_NEAR(state_of(world, 4).world_from_object.translation.z(), 0.075, 0.005);
    EXPECT_TRUE(state_of(world, 4).linear_velocity.isZero(0.0)) << "it sleeps";
}

}  // namespace
}  // namespace atrium::physics
