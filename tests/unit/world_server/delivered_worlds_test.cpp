#include "tests/support/source_dir.hpp"
#include "tests/support/world/load_world.hpp"
#include "world_server/description/doubts.hpp"
#include "world_server/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

// Every delivered world loads, and stays calm until somebody touches it.
namespace atrium::world_server {
namespace {

std::filesystem::path world_file(const std::string& name) {
    return std::filesystem::path(atrium::test::source_dir()) / "deploy/worlds" / name;
}

std::map<std::uint32_t, physics::RigidState> states_of(Scene& scene) {
    std::vector<physics::RigidState> states;
    scene.world().get_states(states);
    std::map<std::uint32_t, physics::RigidState> by_id;
    for (const physics::RigidState& state : states) by_id[state.id] = state;
    return by_id;
}

// Angle between an object's up direction and that of its world file [rad].
double lean(const bus::SceneObject& object, const physics::RigidState& state) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const double cosine =
        (object.world_from_object.rotation * up).dot(state.world_from_object.rotation * up);
    return std::acos(std::clamp(cosine, -1.0, 1.0));
}

class DeliveredWorld : public testing::TestWithParam<std::string> {};

TEST_P(DeliveredWorld, LoadsAndComesToRest) {
    const auto config = test_support::load_world(world_file(GetParam()));
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_THAT(doubts_about(*config, config->tick_hz), testing::IsEmpty());
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene) << scene.error().message;
    double fastest = 0.0;
    for (int i = 0; i < 20 * 120; ++i) {
        scene->world().tick();
        if (i % 12 != 0) continue;
        for (const auto& [id, state] : states_of(*scene))
            fastest = std::max(fastest, state.linear_velocity.norm());
    }
    EXPECT_LT(fastest, 7.0) << "objects fall from below 2 m";
    const auto objects = scene->objects();
    const auto states = states_of(*scene);
    for (const bus::SceneObject& object : objects) {
        if (object.shape == bus::Shape::kSoft) continue;
        const physics::RigidState& state = states.at(object.object);
        EXPECT_LT(state.linear_velocity.norm(), 0.15) << object.name;
    }
    std::vector<physics::Incident> incidents;
    EXPECT_TRUE(scene->take_removed(incidents).empty());
    for (const physics::Incident& incident : incidents)
        ADD_FAILURE() << "object " << incident.object << " " << physics::describe(incident.kind);
}

std::vector<std::string> delivered() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(world_file(""))) {
        if (entry.path().extension() == ".toml") names.push_back(entry.path().filename());
    }
    std::sort(names.begin(), names.end());
    return names;
}

INSTANTIATE_TEST_SUITE_P(Worlds,
                         DeliveredWorld,
                         testing::ValuesIn(delivered()),
                         [](const auto& world) {
                             return world.param.substr(0, world.param.find('.'));
                         });

TEST(BallPit, KeepsItsBallsBehindItsWalls) {
    const auto config = test_support::load_world(world_file("ballpit.toml"));
    ASSERT_TRUE(config) << config.error().message;
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene);
    for (int i = 0; i < 10 * 120; ++i) scene->world().tick();
    int num_balls = 0, num_inside = 0;
    const auto states = states_of(*scene);
    for (const bus::SceneObject& object : scene->objects()) {
        if (object.shape != bus::Shape::kSphere) continue;
        ++num_balls;
        const Eigen::Vector3d p = states.at(object.object).world_from_object.translation;
        num_inside += std::abs(p.x()) < 0.5 && std::abs(p.y()) < 0.8 ? 1 : 0;
    }
    EXPECT_GE(num_balls, 60);
    EXPECT_GE(num_inside, num_balls - 4);
}

struct Row {
    std::vector<bus::SceneObject> dominoes;
    bus::SceneObject ball;
};

Row row_of(const Scene& scene) {
    Row row;
    for (const bus::SceneObject& object : scene.objects()) {
        if (object.name.starts_with("domino-")) row.dominoes.push_back(object);
        if (object.name == "ball") row.ball = object;
    }
    return row;
}

int num_fallen(Scene& scene, const Row& row) {
    const auto states = states_of(scene);
    return static_cast<int>(
        std::count_if(row.dominoes.begin(), row.dominoes.end(), [&](const bus::SceneObject& d) {
            return lean(d, states.at(d.object)) > 0.5;
        }));
}

TEST(Dominoes, StandUntilTheFirstIsPushedThenAllFall) {
    const auto config = test_support::load_world(world_file("dominoes.toml"));
    ASSERT_TRUE(config) << config.error().message;
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene);
    const Row row = row_of(*scene);
    ASSERT_GE(row.dominoes.size(), 20U);
    for (int i = 0; i < 20 * 120; ++i) scene->world().tick();
    for (const auto& [id, state] : states_of(*scene)) {
        if (id < row.dominoes.front().object) continue;
        EXPECT_LT(lean(row.dominoes.at(id - row.dominoes.front().object), state), 0.01);
    }
    // against its upper edge, as a finger would
    const bus::SceneObject& first = row.dominoes.front();
    const Eigen::Vector3d ahead = first.world_from_object.rotation * Eigen::Vector3d::UnitX();
    physics::RigidState tipped = states_of(*scene).at(first.object);
    tipped.angular_velocity = 3.0 * (first.world_from_object.rotation * Eigen::Vector3d::UnitY());
    tipped.linear_velocity = 3.0 * 0.075 * ahead;
    ASSERT_TRUE(scene->world().set_state(tipped));
    for (int i = 0; i < 8 * 120; ++i) scene->world().tick();
    EXPECT_EQ(num_fallen(*scene, row), static_cast<int>(row.dominoes.size()));
}

TEST(Dominoes, TheBallOnTheRampKnocksThemOver) {
    const auto config = test_support::load_world(world_file("dominoes.toml"));
    ASSERT_TRUE(config) << config.error().message;
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene);
    const Row row = row_of(*scene);
    for (int i = 0; i < 240; ++i) scene->world().tick();
    ASSERT_EQ(num_fallen(*scene, row), 0);
    ASSERT_TRUE(scene->world().push(row.ball.object, {0, 0.4 * row.ball.mass_kg, 0}));
    for (int i = 0; i < 10 * 120; ++i) scene->world().tick();
    EXPECT_EQ(num_fallen(*scene, row), static_cast<int>(row.dominoes.size()));
}

}  // namespace
}  // namespace atrium::world_server
