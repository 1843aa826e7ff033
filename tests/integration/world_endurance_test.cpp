#include "tests/support/source_dir.hpp"
#include "tests/support/world/endurance.hpp"
#include "tests/support/world/load_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>

// Some seconds of what bench/world/world_endurance does for minutes. Two people walk through every
// delivered world, act, and nothing explodes. Their surfaces do not come from cameras here.
namespace atrium::test {
namespace {

constexpr double kSeconds = 6.0;
constexpr double kRateHz = 30.0;
constexpr int kTicksPerPicture = 4;

struct Walked {
    std::string name;
    std::unique_ptr<world_server::Scene> scene;
    std::unique_ptr<WorldWatch> watch;
};

std::vector<Walked> delivered_worlds(const EnduranceBounds& bounds) {
    std::vector<Walked> worlds;
    for (const auto& entry :
         std::filesystem::directory_iterator(atrium::test::source_dir() + "/deploy/worlds")) {
        if (entry.path().extension() != ".toml") continue;
        const auto config = test_support::load_world(entry.path());
        if (!config) ADD_FAILURE() << config.error().message;
        if (!config) continue;
        EXPECT_EQ(config->tick_hz, kRateHz * kTicksPerPicture) << entry.path();
        auto scene = world_server::Scene::create(*config);
        if (!scene) ADD_FAILURE() << scene.error().message;
        if (!scene) continue;
        Walked world;
        world.name = entry.path().stem();
        world.scene = std::make_unique<world_server::Scene>(std::move(*scene));
        world.watch = std::make_unique<WorldWatch>(*world.scene, config->joints, bounds);
        worlds.push_back(std::move(world));
    }
    return worlds;
}

TEST(WorldEndurance, DeliveredWorldsStayCalmWithTwoPeople) {
    const Act act = wander_act("ada");
    const auto worlds = delivered_worlds({.people_mps = wander_speed_mps(act)});
    ASSERT_GE(worlds.size(), 6U);
    const ActedPerson body(act);
    std::vector<physics::PersonShaper> shapers(
        2, physics::PersonShaper(physics::PersonShapeOptions{}));
    for (int picture = 0; picture < static_cast<int>(kSeconds * kRateHz); ++picture) {
        const double time_s = picture / kRateHz;
        for (std::size_t p = 0; p < shapers.size(); ++p) {
            const double own_s = time_s + static_cast<double>(p) * kWanderLoopS / 2.0;
            auto mesh = body.mesh_site(own_s);
            const auto place = wander_place(time_s, 2.0 * static_cast<double>(p));
            for (Eigen::Vector3d& vertex : mesh.vertices) vertex = place * vertex;
            const auto shape =
                shapers[p].shape(mesh, Timestamp{1'000'000'000 + picture * 33'333'333LL});
            for (const Walked& world : worlds)
                world.scene->world().set_person(p == 0 ? "ada" : "bob", shape);
        }
        for (const Walked& world : worlds) {
            for (int i = 0; i < kTicksPerPicture; ++i) {
                world.scene->world().tick();
                world.watch->look(time_s);
            }
        }
    }
    for (const Walked& world : worlds) {
        const EnduranceFigures& figures = world.watch->figures();
        EXPECT_EQ(figures.broken, "") << world.name;
        EXPECT_GT(world.scene->world().counters().num_contact_ticks, 12U)
            << world.name << ": the people have to meet something";
        EXPECT_GT(figures.rigid_mps + figures.soft_mps, 0.3) << world.name;
    }
}

// Tests that the watch finds broken bounds.
TEST(WorldEndurance, WatchReportsObjectsTooFastOrTooDeep) {
    world_server::WorldServerConfig config;
    world_server::WorldObject ball;
    ball.rigid.id = 1;
    ball.name = "ball";
    ball.rigid.shape = physics::ObjectShape::kSphere;
    ball.rigid.size_m.setConstant(0.2);
    ball.rigid.mass_kg = 1.0;
    ball.rigid.world_from_object.translation = {0.0, 0.0, 1.0};
    config.objects = {ball};
    const EnduranceBounds bounds{.people_mps = 1.0, .untouched_gain_j = 0.1};
    const auto broken_after = [&](const physics::RigidState& state) {
        auto scene = world_server::Scene::create(config);
        EXPECT_TRUE(scene);
        WorldWatch watch(*scene, config.joints, bounds);
        for (int i = 0; i < 3; ++i) {
            scene->world().tick();
            watch.look(0.0);
        }
        EXPECT_EQ(watch.figures().broken, "") << "a falling object must not be reported";
        EXPECT_TRUE(scene->world().set_state(state));
        scene->world().tick();
        watch.look(1.0);
        return watch.figures().broken;
    };
    physics::RigidState state;
    state.id = 1;
    state.world_from_object.translation = {0.0, 0.0, 0.9};
    state.linear_velocity = {9.0, 0.0, 0.0};
    EXPECT_NE(broken_after(state).find("ball [m2/s2]"), std::string::npos);
    state.linear_velocity = {2.0, 0.0, 0.0};
    EXPECT_NE(broken_after(state).find("energy from nowhere"), std::string::npos);
    state.linear_velocity.setZero();
    state.world_from_object.translation.z() = -0.5;
    EXPECT_NE(broken_after(state).find("below the floor"), std::string::npos);
}

TEST(WorldEndurance, WatchBoundsJoinedObjectsAsAWhole) {
    world_server::WorldServerConfig config;
    for (const std::uint32_t id : {1U, 2U}) {
        world_server::WorldObject ball;
        ball.rigid.id = id;
        ball.name = id == 1 ? "hand" : "body";
        ball.rigid.shape = physics::ObjectShape::kSphere;
        ball.rigid.size_m.setConstant(0.2);
        ball.rigid.mass_kg = id == 1 ? 0.1 : 10.0;
        ball.rigid.world_from_object.translation = {0.0, 0.25 * id, 1.0};
        config.objects.push_back(ball);
    }
    const auto broken_with = [&](const std::vector<physics::Joint>& joints,
                                 const EnduranceBounds& bounds) {
        auto scene = world_server::Scene::create(config);
        EXPECT_TRUE(scene);
        WorldWatch watch(*scene, joints, bounds);
        physics::RigidState state;
        state.id = 1;
        state.world_from_object.translation = {0.0, 0.25, 1.0};
        state.linear_velocity = {9.0, 0.0, 0.0};
        EXPECT_TRUE(scene->world().set_state(state));
        scene->world().tick();
        watch.look(0.0);
        return watch.figures().broken;
    };
    const std::vector<physics::Joint> joined{{.a = 1, .b = 2}};
    EXPECT_NE(broken_with({}, {.people_mps = 1.0}).find("hand [m2/s2]"), std::string::npos);
    EXPECT_EQ(broken_with(joined, {.people_mps = 1.0}), "");
    EXPECT_NE(broken_with(joined, {.people_mps = 1.0, .part_mps = 8.0}).find("hand [m/s]"),
              std::string::npos);
}

}  // namespace
}  // namespace atrium::test
