#include "world_server/physics/state/world_state.hpp"

#include "tests/support/sanitized.hpp"
#include "tests/support/world/physics_meshes.hpp"
#include "world_server/physics/soft/soft_object.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace atrium::physics {
namespace {

// Objects of every shape above a floor. They fall, collide and roll, and some come to rest.
void add_things(World& world) {
    world.add({.id = 1, .shape = ObjectShape::kPlane});
    std::mt19937 random(5);
    std::uniform_real_distribution<double> anywhere(-0.4, 0.4);
    constexpr std::array kShapes{
        ObjectShape::kBox, ObjectShape::kSphere, ObjectShape::kCylinder, ObjectShape::kCapsule};
    for (std::uint32_t id = 2; id < 34; ++id) {
        const ObjectShape shape = kShapes[id % kShapes.size()];
        const bool is_long = shape == ObjectShape::kCylinder || shape == ObjectShape::kCapsule;
        world.add({.id = id,
                   .shape = shape,
                   .size_m = {0.15, 0.15, is_long ? 0.3 : 0.15},
                   .mass_kg = 0.4,
                   .world_from_object = {
                       Eigen::Quaterniond(1, anywhere(random), anywhere(random), 0).normalized(),
                       {anywhere(random), anywhere(random), 0.15 * id}}});
    }
}

// A chain of four boxes on a ball joint, hinges and a spring, which swings among the objects.
void add_chain(World& world) {
    for (std::uint32_t id = 60; id < 64; ++id) {
        world.add(
            {.id = id,
             .size_m = {0.3, 0.1, 0.1},
             .mass_kg = 0.5,
             .world_from_object = {Eigen::Quaterniond::Identity(), {0.4 * (id - 60.0), 0, 1.8}}});
    }
    Joint ball{.kind = JointKind::kBall, .a = 60};
    ball.anchor_m = {-0.2, 0, 1.8};
    ASSERT_TRUE(world.add_joint(ball));
    for (std::uint32_t id = 61; id < 63; ++id) {
        Joint hinge{.kind = JointKind::kHinge, .a = id, .b = id - 1};
        hinge.anchor_m = {0.4 * (id - 60.0) - 0.2, 0, 1.8};
        hinge.axis = Eigen::Vector3d::UnitY();
        hinge.damping = 0.02;
        ASSERT_TRUE(world.add_joint(hinge));
    }
    Joint spring{.kind = JointKind::kSpring, .a = 63, .b = 62};
    spring.anchor_m = {1.05, 0, 1.8};
    spring.anchor_b_m = {0.95, 0, 1.8};
    spring.stiffness_npm = 80.0;
    spring.rest_length_m = 0.1;
    ASSERT_TRUE(world.add_joint(spring));
}

// A cloth that hangs where the objects fall, and a soft ball among them.
void add_soft_things(World& world) {
    SoftObject cloth;
    cloth.id = 50;
    cloth.pins.resize(1);
    cloth.world_from_object.translation = {0, 0.1, 1.5};
    ASSERT_EQ(world.add_soft(cloth), AddResult::kAdded);
    SoftObject ball;
    ball.id = 51;
    ball.shape = SoftShape::kBall;
    ball.size_m = {0.3, 0.3, 0.3};
    ball.spacing_m = 0.08;
    ball.mass_kg = 0.5;
    ball.world_from_object.translation = {0.2, 0, 0.8};
    ASSERT_EQ(world.add_soft(ball), AddResult::kAdded);
}

// The input of a tick, the same in every run.
void input(World& world, int tick) {
    if (tick % 40 == 7) world.push(2 + static_cast<std::uint32_t>(tick) % 30, {0.6, -0.3, 0.8});
    if (tick == 130) world.grab("eve", 5, {0, 0, 0}, {0.2, 0.2, 1.0});
    if (tick == 145) world.release("eve", 5);
    if (tick == 200) world.remove(9);
    if (tick == 210) {
        world.add({.id = 90,
                   .shape = ObjectShape::kSphere,
                   .size_m = {0.2, 0.2, 0.2},
                   .mass_kg = 0.5,
                   .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 2}}});
    }
}

// A person who walks through the objects.
class Walker {
public:
    void set(World& world, int tick) {
        if (tick % 4 != 0) return;
        const double x_m = -1.0 + 0.01 * tick;
        const geometry::RigidTransform pose{Eigen::Quaterniond::Identity(), {x_m, 0, 0.5}};
        const auto mesh = physics_test::make_box_mesh({0.3, 0.5, 1.0}, pose, 4);
        const Timestamp time{1'000'000'000LL + tick * 8'333'333LL};
        const PersonShape shape = shaper_.shape(mesh, time);
        world.set_person("alice", shape);
    }

private:
    PersonShaper shaper_{PersonShapeOptions{}};
};

TEST(RecordedInput, GivesTheSameHashTwice) {
    World first{{}};
    World second{{}};
    add_things(first);
    add_things(second);
    Walker walker1;
    Walker walker2;
    for (int tick = 0; tick < 400; ++tick) {
        if (tick > 50 && tick < 250) {
            walker1.set(first, tick);
            walker2.set(second, tick);
        }
        if (tick == 250) first.remove_person("alice");
        if (tick == 250) second.remove_person("alice");
        input(first, tick);
        input(second, tick);
        first.tick();
        second.tick();
        ASSERT_EQ(first.state_hash(), second.state_hash()) << "tick " << tick;
    }
}

TEST(RecordedInput, GivesTheSameHashFromARestoredState) {
    const auto save_ticks = test::kSanitized ? std::vector{300} : std::vector{1, 60, 150, 300};
    for (const int save_at : save_ticks) {
        World world{{}};
        add_things(world);
        add_soft_things(world);
        add_chain(world);
        WorldState state;
        for (int tick = 0; tick < save_at; ++tick) {
            input(world, tick);
            world.tick();
        }
        world.get_state(state);
        const std::uint64_t hash = world.state_hash();
        ASSERT_TRUE(world.set_state(state))
            << "the saving world must continue from its saved state";
        EXPECT_EQ(world.state_hash(), hash) << "the restore must not move the world";

        World restored{{}};
        add_things(restored);
        add_soft_things(restored);
        add_chain(restored);
        if (save_at > 200) restored.remove(9);
        if (save_at > 210) {
            restored.add({.id = 90,
                          .shape = ObjectShape::kSphere,
                          .size_m = {0.2, 0.2, 0.2},
                          .mass_kg = 0.5});
        }
        ASSERT_TRUE(restored.set_state(state));
        EXPECT_EQ(restored.state_hash(), hash);
        EXPECT_EQ(restored.counters().num_ticks, static_cast<std::uint64_t>(save_at));
        Walker walker1;
        Walker walker2;
        for (int tick = save_at; tick < save_at + 240; ++tick) {
            if (tick > save_at + 40) {
                walker1.set(world, tick - save_at);
                walker2.set(restored, tick - save_at);
            }
            input(world, tick);
            input(restored, tick);
            world.tick();
            restored.tick();
            ASSERT_EQ(world.state_hash(), restored.state_hash())
                << "saved at " << save_at << ", tick " << tick;
        }
    }
}

TEST(WorldState, SavingHardlyDisturbsAStack) {
    World world{{}};
    world.add({.id = 1, .shape = ObjectShape::kPlane});
    for (std::uint32_t id = 2; id < 7; ++id) {
        world.add(
            {.id = id,
             .shape = ObjectShape::kBox,
             .size_m = {0.2, 0.2, 0.2},
             .mass_kg = 1.0,
             .world_from_object = {Eigen::Quaterniond::Identity(), {0, 0, 0.1 + 0.2 * (id - 2)}}});
    }
    WorldState state;
    for (int i = 0; i < 1200; ++i) {
        world.tick();
        if (i % 60 == 0) {
            world.get_state(state);
            ASSERT_TRUE(world.set_state(state));
        }
    }
    std::vector<RigidState> states;
    world.get_states(states);
    for (std::size_t i = 1; i < states.size(); ++i) {
        const Eigen::Vector3d& p = states[i].world_from_object.translation;
        EXPECT_NEAR(p.z(), 0.1 + 0.2 * static_cast<double>(i - 1), 0.005);
        EXPECT_LT(p.head<2>().norm(), 0.005);
    }
}

TEST(WorldState, ChangesNothingIfInvalid) {
    World world{{}};
    add_things(world);
    for (int i = 0; i < 30; ++i) world.tick();
    WorldState good;
    world.get_state(good);
    const std::uint64_t hash = world.state_hash();
    const auto refused = [&](const std::function<void(ObjectMotion&)>& spoil) {
        WorldState bad = good;
        for (ObjectMotion& motion : bad.objects) motion.position_m.x() += 1.0F;
        spoil(bad.objects.back());
        return !world.set_state(bad) && world.state_hash() == hash;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(refused([](ObjectMotion& m) { m.id = 77; }));
    EXPECT_TRUE(refused([&](ObjectMotion& m) { m.position_m.y() = nan; }));
    EXPECT_TRUE(refused([&](ObjectMotion& m) { m.rotation(1, 2) = nan; }));
    EXPECT_TRUE(refused([](ObjectMotion& m) { m.rotation *= 1.1F; }));
    EXPECT_TRUE(refused([](ObjectMotion& m) { m.rotation = -m.rotation; }));
    EXPECT_TRUE(refused([](ObjectMotion& m) { m.rotation.setZero(); }));
    EXPECT_TRUE(refused([&](ObjectMotion& m) { m.linear_velocity.z() = nan; }));
    EXPECT_TRUE(refused([&](ObjectMotion& m) { m.angular_velocity.x() = nan; }));
    EXPECT_TRUE(refused([](ObjectMotion& m) { m.activation = 5; }));
    EXPECT_TRUE(refused([](ObjectMotion& m) { m.activation = 0; }));
    EXPECT_TRUE(refused([&](ObjectMotion& m) { m.idle_s = nan; }));
}

}  // namespace
}  // namespace atrium::physics
