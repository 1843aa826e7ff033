#include "world_server/description/puppet.hpp"

#include "tests/support/sanitized.hpp"
#include "tests/unit/physics/things.hpp"

#include <gmock/gmock.h>

#include <set>

namespace atrium::world_server {
namespace {

using physics::World;

Puppet add_puppet(World& world, const PuppetDescription& description) {
    Puppet puppet = make_puppet(description, 100);
    for (const WorldObject& part : puppet.parts)
        EXPECT_EQ(world.add(to_rigid(part)), physics::AddResult::kAdded) << part.name;
    for (const physics::Joint& joint : puppet.joints) EXPECT_TRUE(world.add_joint(joint));
    return puppet;
}

// Kinetic and potential energy of the parts, without rotation [J].
double energy_j(const World& world, const Puppet& puppet) {
    double sum = 0.0;
    for (const WorldObject& part : puppet.parts) {
        const physics::RigidState state = physics::state_of(world, part.rigid.id);
        sum += part.rigid.mass_kg * (0.5 * state.linear_velocity.squaredNorm() +
                                     9.81 * state.world_from_object.translation.z());
    }
    return sum;
}

double fastest_mps(const World& world, const Puppet& puppet) {
    double fastest = 0.0;
    for (const WorldObject& part : puppet.parts) {
        fastest = std::max(fastest, physics::state_of(world, part.rigid.id).linear_velocity.norm());
    }
    return fastest;
}

double widest_gap_m(const World& world, const Puppet& puppet) {
    double widest = 0.0;
    const auto part = [&](std::uint32_t id) { return to_rigid(puppet.parts[id - 100]); };
    for (const physics::Joint& joint : puppet.joints) {
        if (joint.b == 0) continue;
        widest = std::max(widest,
                          (physics::now_at(world, part(joint.a), joint.anchor_m) -
                           physics::now_at(world, part(joint.b), joint.anchor_m))
                              .norm());
    }
    return widest;
}

TEST(Puppet, HasThirteenNamedPartsAndTheJointsBetweenThem) {
    const Puppet puppet = make_puppet({.name = "p", .string_m = 0.0}, 7);
    ASSERT_EQ(puppet.parts.size(), kNumPuppetParts);
    EXPECT_EQ(puppet.joints.size(), kNumPuppetParts - 1);
    std::set<std::string> names;
    double mass_kg = 0.0;
    for (std::size_t i = 0; i < puppet.parts.size(); ++i) {
        EXPECT_EQ(puppet.parts[i].rigid.id, 7 + i);
        names.insert(puppet.parts[i].name);
        mass_kg += puppet.parts[i].rigid.mass_kg;
    }
    EXPECT_EQ(names.size(), kNumPuppetParts);
    EXPECT_TRUE(names.contains("p.forearm_l"));
    EXPECT_GT(mass_kg, 0.3);
    EXPECT_LT(mass_kg, 1.5);
}

class PuppetOfHeight : public testing::TestWithParam<double> {};

TEST_P(PuppetOfHeight, FallsAndRestsWithoutTearingOrGainingEnergy) {
    World world({});
    ASSERT_EQ(world.add(physics::floor_plane()), physics::AddResult::kAdded);
    PuppetDescription description{.name = "p", .height_m = GetParam()};
    description.world_from_puppet = {
        Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 0).normalized())),
        {0, 0, 1.0}};
    const Puppet puppet = add_puppet(world, description);
    double energy_before = energy_j(world, puppet);
    const double energy_at_start = energy_before;
    double late_fastest = 0.0;
    for (int i = 0; i < 60 * 120; ++i) {
        world.tick();
        const double energy = energy_j(world, puppet);
        // limits and contacts return a little of the energy that they take
        ASSERT_LT(energy, energy_at_start * 1.02);
        ASSERT_LT(widest_gap_m(world, puppet), 0.05 * GetParam()) << "tick " << i;
        ASSERT_LT(fastest_mps(world, puppet), 10.0);
        if (i > 20 * 120) late_fastest = std::max(late_fastest, fastest_mps(world, puppet));
    }
    EXPECT_LT(late_fastest, 0.05) << "the puppet must lie still without twitching";
    std::vector<physics::Incident> incidents;
    world.take_incidents(incidents);
    EXPECT_TRUE(incidents.empty());
}

TEST_P(PuppetOfHeight, HangsByItsStringsAndRestsAfterAHit) {
    World world({});
    PuppetDescription description{.name = "p", .height_m = GetParam(), .string_m = 0.5};
    description.world_from_puppet.translation = {0, 0, 1.0};
    const Puppet puppet = add_puppet(world, description);
    physics::run(world, 10.0);
    const auto chest = [&] { return physics::state_of(world, 101); };
    EXPECT_LT(fastest_mps(world, puppet), 0.15);
    const double height = chest().world_from_object.translation.z();
    EXPECT_GT(height, 1.0 + 0.69 * GetParam() - 0.1 * GetParam() - 0.03);
    ASSERT_TRUE(world.push(101, Eigen::Vector3d(2.0 * puppet.parts[1].rigid.mass_kg, 0, 0)));
    double furthest = 0.0;
    for (int i = 0; i < 60 * 120; ++i) {
        world.tick();
        ASSERT_LT(fastest_mps(world, puppet), 6.0);
        ASSERT_LT(widest_gap_m(world, puppet), 0.05 * GetParam());
        furthest = std::max(furthest, chest().world_from_object.translation.x());
    }
    EXPECT_GT(furthest, 0.03) << "it swings";
    EXPECT_LT(fastest_mps(world, puppet), 0.1) << "the puppet must come to rest";
}

// Somebody pulls the puppet away and releases it. The energy stored in the strings must not fling
// it.
TEST_P(PuppetOfHeight, IsNotFlungByItsStrings) {
    World world({});
    PuppetDescription description{.name = "p", .height_m = GetParam(), .string_m = 0.5};
    description.world_from_puppet.translation = {0, 0, 1.0};
    const Puppet puppet = add_puppet(world, description);
    physics::run(world, 5.0);
    for (const WorldObject& part : puppet.parts) {
        physics::RigidState state = physics::state_of(world, part.rigid.id);
        state.world_from_object.translation += Eigen::Vector3d(0.8, 0.0, 0.0);
        ASSERT_TRUE(world.set_state(state));
    }
    double furthest_back = 1.0;
    for (int i = 0; i < 240; ++i) {
        world.tick();
        ASSERT_LT(fastest_mps(world, puppet), 8.0) << "tick " << i;
        const double x = physics::state_of(world, 101).world_from_object.translation.x();
        furthest_back = std::min(furthest_back, x);
    }
    EXPECT_LT(furthest_back, 0.1) << "the puppet must swing back";
    EXPECT_EQ(world.counters().num_torn + world.counters().num_runaways, 0U);
}

TEST_P(PuppetOfHeight, StaysInOnePieceWhenThrownHard) {
    World world({});
    ASSERT_EQ(world.add(physics::floor_plane()), physics::AddResult::kAdded);
    PuppetDescription description{.name = "p", .height_m = GetParam()};
    description.world_from_puppet.translation = {0, 0, 0.5};
    const Puppet puppet = add_puppet(world, description);
    // by one hand, as if somebody tore at it
    const WorldObject& forearm = puppet.parts[4];
    ASSERT_EQ(forearm.name, "p.forearm_l");
    for (int hit = 0; hit < 20; ++hit) {
        const double side = hit % 2 == 0 ? 1.0 : -1.0;
        ASSERT_TRUE(world.push(forearm.rigid.id,
                               forearm.rigid.mass_kg * Eigen::Vector3d(12.0 * side, 3.0, 6.0)));
        for (int i = 0; i < 60; ++i) {
            world.tick();
            ASSERT_LT(fastest_mps(world, puppet), 16.0);
            // during the pull; the width of the gap depends on the compiler's rounding
            ASSERT_LT(widest_gap_m(world, puppet), 0.2 * GetParam());
        }
    }
    EXPECT_EQ(world.counters().num_torn + world.counters().num_runaways, 0U);
}

INSTANTIATE_TEST_SUITE_P(Metres,
                         PuppetOfHeight,
                         testing::ValuesIn(test::kSanitized ? std::vector{0.6}
                                                            : std::vector{0.4, 0.6, 1.2}));

}  // namespace
}  // namespace atrium::world_server
