#include "world_server/physics/world.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace atrium::physics {
namespace {

RigidObject floor_object(std::uint32_t id = 1) {
    return {.id = id, .shape = ObjectShape::kPlane, .size_m = {10, 10, 0}};
}
RigidObject ball(std::uint32_t id, const Eigen::Vector3d& position, double diameter_m = 0.1) {
    return {.id = id,
            .shape = ObjectShape::kSphere,
            .size_m = Eigen::Vector3d::Constant(diameter_m),
            .mass_kg = 0.3 * std::pow(diameter_m / 0.1, 3),
            .world_from_object = {Eigen::Quaterniond::Identity(), position}};
}
RigidObject box(std::uint32_t id, const Eigen::Vector3d& position) {
    return {.id = id,
            .size_m = {0.2, 0.3, 0.25},
            .mass_kg = 3.0,
            .world_from_object = {Eigen::Quaterniond::Identity(), position}};
}
void run(World& world, double seconds) {
    const int num_ticks = static_cast<int>(std::lround(seconds * 120.0));
    for (int i = 0; i < num_ticks; ++i) world.tick();
}
RigidState state_of(const World& world, std::uint32_t id) {
    std::vector<RigidState> states;
    world.get_states(states);
    for (const RigidState& s : states) {
        if (s.id == id) return s;
    }
    ADD_FAILURE() << "no object " << id;
    return {};
}

TEST(World, LetsABallFallByGalileosLaw) {
    World world({});
    ASSERT_EQ(world.add(ball(2, {0, 0, 10})), AddResult::kAdded);
    run(world, 1.0);
    // the air damping of 2 % per second costs 3 cm; the semi-implicit step adds 4 cm
    EXPECT_NEAR(state_of(world, 2).world_from_object.translation.z(), 10.0 - 4.905, 0.1);
}

TEST(World, BringsEveryShapeToRestOnTheFloor) {
    World world({});
    ASSERT_EQ(world.add(floor_object()), AddResult::kAdded);
    ASSERT_EQ(world.add(ball(2, {0, 0, 0.5})), AddResult::kAdded);
    ASSERT_EQ(world.add(box(3, {1, 0, 0.5})), AddResult::kAdded);
    RigidObject cylinder = box(4, {2, 0, 0.5});
    cylinder.shape = ObjectShape::kCylinder;
    cylinder.size_m = {0.2, 0.2, 0.3};
    ASSERT_EQ(world.add(cylinder), AddResult::kAdded);
    RigidObject capsule = cylinder;
    capsule.id = 5;
    capsule.shape = ObjectShape::kCapsule;
    capsule.world_from_object = {
        Eigen::Quaterniond(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitX())), {3, 0, 0.5}};
    ASSERT_EQ(world.add(capsule), AddResult::kAdded);
    run(world, 4.0);
    const double heights_m[] = {0.05, 0.125, 0.15, 0.1};
    for (std::uint32_t id = 2; id <= 5; ++id) {
        const RigidState state = state_of(world, id);
        EXPECT_NEAR(state.world_from_object.translation.z(), heights_m[id - 2], 0.004) << id;
        EXPECT_LT(state.linear_velocity.norm(), 0.02) << id;
    }
}

TEST(World, KeepsATowerOfBoxesStanding) {
    World world({});
    ASSERT_EQ(world.add(floor_object()), AddResult::kAdded);
    for (std::uint32_t i = 0; i < 5; ++i) {
        ASSERT_EQ(world.add(box(2 + i, {0, 0, 0.125 + 0.25 * i})), AddResult::kAdded);
    }
    run(world, 5.0);
    const RigidState top = state_of(world, 6);
    EXPECT_NEAR(top.world_from_object.translation.z(), 0.125 + 4 * 0.25, 0.02);
    EXPECT_LT(top.world_from_object.translation.head<2>().norm(), 0.02);
}

TEST(World, KeepsATowerStandingWhoseMiddleIsAHundredTimesLighterThanItsTop) {
    World world({});
    world.add(floor_object());
    const std::array<double, 3> masses_kg{45.0, 0.7, 70.0};
    std::vector<RigidObject> tower;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const RigidObject layer{
            .id = 2 + i,
            .size_m = {0.3, 0.3, 0.2},
            .mass_kg = masses_kg[i],
            .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 0.1 + 0.2 * i}}};
        tower.push_back(layer);
        ASSERT_EQ(world.add(layer), AddResult::kAdded);
    }
    for (int i = 0; i < 60 * 120; ++i) world.tick();
    for (const RigidObject& layer : tower) {
        const Eigen::Vector3d start = layer.world_from_object.translation;
        const Eigen::Vector3d moved =
            state_of(world, layer.id).world_from_object.translation - start;
        EXPECT_LT(moved.norm(), 0.005) << layer.id;
    }
}

TEST(World, RefusesInvalidObjects) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    World world({.max_objects = 2});
    const auto refused = [&](auto change) {
        RigidObject object = ball(7, {0, 0, 1});
        change(object);
        return world.add(object) == AddResult::kInvalid;
    };
    EXPECT_TRUE(refused([&](RigidObject& o) { o.world_from_object.translation.x() = kNan; }));
    EXPECT_TRUE(refused([&](RigidObject& o) { o.world_from_object.rotation.w() = kNan; }));
    EXPECT_TRUE(refused([&](RigidObject& o) { o.world_from_object.rotation.coeffs().setZero(); }));
    EXPECT_TRUE(refused([&](RigidObject& o) { o.size_m.setConstant(0.0); }));
    EXPECT_TRUE(refused([&](RigidObject& o) { o.size_m.setConstant(1e9); }));
    EXPECT_TRUE(refused([&](RigidObject& o) { o.size_m.z() = 0.3; })) << "an egg";
    EXPECT_TRUE(refused([&](RigidObject& o) { o.mass_kg = -1.0; }));
    EXPECT_TRUE(refused([&](RigidObject& o) { o.mass_kg = 1000.0; }))
        << "an object denser than any metal";
    EXPECT_TRUE(refused([&](RigidObject& o) { o.friction = -0.1; }));
    EXPECT_TRUE(refused([&](RigidObject& o) { o.restitution = 1.5; }));
    EXPECT_TRUE(refused([&](RigidObject& o) { o.shape = ObjectShape::kPlane; }))
        << "a movable plane";
    EXPECT_EQ(world.num_objects(), 0U);

    EXPECT_EQ(world.add(ball(1, {0, 0, 1})), AddResult::kAdded);
    EXPECT_EQ(world.add(ball(1, {0, 0, 2})), AddResult::kIdInUse);
    EXPECT_EQ(world.add(ball(2, {0, 0, 3})), AddResult::kAdded);
    EXPECT_EQ(world.add(ball(3, {0, 0, 4})), AddResult::kWorldFull);
}

TEST(World, PushChangesVelocityByImpulseOverMassAndWakes) {
    World world({});
    ASSERT_EQ(world.add(floor_object()), AddResult::kAdded);
    ASSERT_EQ(world.add(box(2, {0, 0, 0.125})), AddResult::kAdded);
    run(world, 5.0);  // long enough to fall asleep
    ASSERT_TRUE(world.push(2, {0, 0, 9.0}));
    world.tick();
    EXPECT_NEAR(state_of(world, 2).linear_velocity.z(), 3.0 - 9.81 / 120.0, 0.05);
    EXPECT_FALSE(world.push(1, {1, 0, 0})) << "a push of the floor";
    EXPECT_FALSE(world.push(9, {1, 0, 0})) << "nobody";
    EXPECT_FALSE(world.push(2, Eigen::Vector3d::Constant(std::nan(""))));
}

TEST(World, LimitsSpeed) {
    World world({.gravity = Eigen::Vector3d::Zero()});
    ASSERT_EQ(world.add(ball(2, {0, 0, 1})), AddResult::kAdded);
    ASSERT_TRUE(world.push(2, {1e6, 0, 0}));
    for (int i = 0; i < 10; ++i) {
        world.tick();
        EXPECT_LE(state_of(world, 2).linear_velocity.norm(), 15.0001);
    }
}

TEST(World, ResetsAndCountsObjectsThatLeave) {
    World world({});  // no floor
    ASSERT_EQ(world.add(ball(2, {0, 0, 0.5})), AddResult::kAdded);
    run(world, 0.7);
    EXPECT_EQ(world.counters().num_strays, 1U);
    EXPECT_GT(state_of(world, 2).world_from_object.translation.z(), -1.0);
}

TEST(World, SeparatesOverlappingObjectsGently) {
    World world({});
    ASSERT_EQ(world.add(floor_object()), AddResult::kAdded);
    for (std::uint32_t i = 0; i < 6; ++i) {  // all at the same place
        ASSERT_EQ(world.add(box(2 + i, {0.001 * i, 0, 0.2})), AddResult::kAdded);
    }
    double fastest = 0.0;
    for (int i = 0; i < 360; ++i) {
        world.tick();
        for (std::uint32_t id = 2; id < 8; ++id) {
            fastest = std::max(fastest, state_of(world, id).linear_velocity.norm());
        }
    }
    EXPECT_LT(fastest, 4.0);
    EXPECT_EQ(world.counters().num_not_finite, 0U);
}

TEST(World, ResetReturnsEverythingAtRest) {
    World world({});
    ASSERT_EQ(world.add(floor_object()), AddResult::kAdded);
    ASSERT_EQ(world.add(ball(2, {0.3, 0, 1.0})), AddResult::kAdded);
    run(world, 1.0);
    world.reset();
    const RigidState state = state_of(world, 2);
    EXPECT_LT((state.world_from_object.translation - Eigen::Vector3d(0.3, 0, 1.0)).norm(), 1e-6);
    EXPECT_EQ(state.linear_velocity, Eigen::Vector3d::Zero());
    run(world, 0.2);
    EXPECT_LT(state_of(world, 2).world_from_object.translation.z(), 0.9)
        << "the object must fall again";
}

TEST(World, ObjectsOnARemovedObjectFall) {
    World world({});
    ASSERT_EQ(world.add(floor_object()), AddResult::kAdded);
    ASSERT_EQ(world.add(box(2, {0, 0, 0.125})), AddResult::kAdded);
    ASSERT_EQ(world.add(box(3, {0, 0, 0.375})), AddResult::kAdded);
    run(world, 5.0);
    ASSERT_TRUE(world.remove(2));
    EXPECT_FALSE(world.remove(2));
    run(world, 2.0);
    EXPECT_NEAR(state_of(world, 3).world_from_object.translation.z(), 0.125, 0.01);
}

TEST(World, RepeatsBitByBit) {
    const auto play = [](unsigned seed) {
        World world({});
        world.add(floor_object());
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> place(-0.5, 0.5);
        for (std::uint32_t id = 2; id < 22; ++id) {
            const Eigen::Vector3d position(place(random), place(random), 1.0 + place(random));
            world.add(id % 2 == 0 ? ball(id, position) : box(id, position));
        }
        for (int i = 0; i < 240; ++i) {
            world.tick();
            if (i == 100) world.push(5, {4, 2, 1});
        }
        return world.state_hash();
    };
    EXPECT_EQ(play(1), play(1));
    EXPECT_NE(play(1), play(2));
}

}  // namespace
}  // namespace atrium::physics
