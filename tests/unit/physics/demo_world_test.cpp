// The world that the demo shows, with the people that the demo shows, without cameras or network.
#include "simulation/person.hpp"
#include "world_server/config.hpp"
#include "world_server/physics/person_shape.hpp"
#include "world_server/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace atrium::world_server {
namespace {

constexpr int kTicksPerMesh = 6;  // 20 Hz, as in deploy/sites

Expected<WorldServerConfig> load_demo() {
    auto reader = config::TableReader::load(ATRIUM_SOURCE_DIR "/deploy/worlds/demo.toml");
    if (!reader) return tl::unexpected(reader.error());
    WorldServerConfig config;
    config::OptionSet set;
    declare(config, set);
    set.read_file(*reader);
    read_world(*reader, config);
    if (const auto read = reader->finish(); !read) return tl::unexpected(read.error());
    return config;
}

std::map<std::string, double> heights(Scene& scene) {
    bus::SceneState state;
    scene.get_state("demo", Timestamp{}, state);
    const auto objects = scene.objects();
    std::map<std::string, double> z;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        z[objects[i].name] = state.objects[i].world_from_object.translation.z();
    }
    return z;
}

TEST(DemoWorld, HasThingsThatThePeoplePushToTheFloor) {
    const auto config = load_demo();
    ASSERT_TRUE(config) << config.error().message;
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene);
    ASSERT_EQ(config->placements.size(), 2U);
    const std::string motions[] = {"push", "wave"};  // of alice and bob
    std::vector<simulation::Person> people;
    std::vector<physics::PersonShaper> shapers(2, physics::PersonShaper(config->person));
    for (const std::string& motion : motions) {
        simulation::RoomOptions room;
        room.motion = motion;
        room.heading_rad = -std::numbers::pi / 2;  // faces +X of the site
        auto person = simulation::Person::create(room);
        ASSERT_TRUE(person) << person.error().message;
        people.push_back(std::move(*person));
    }
    for (int tick = 0; tick < 6 * 120; ++tick) {
        for (std::size_t i = 0; i < 2 && tick % kTicksPerMesh == 0; ++i) {
            geometry::TriangleMesh mesh = people[i].mesh(std::fmod(tick / 120.0, 3.0));
            const NamedPlacement& placement = config->placements[i];
            for (Eigen::Vector3d& v : mesh.vertices) v = placement.world_from_site * v;
            scene->world().set_person(
                placement.site,
                shapers[i].shape(mesh, Timestamp{1'000'000'000 + std::int64_t{8'333'333} * tick}));
        }
        scene->world().tick();
    }
    const auto z = heights(*scene);
    EXPECT_LT(z.at("red-ball"), 0.3) << "alice pushes it off the shelf";
    EXPECT_LT(z.at("blue-box"), 0.3) << "alice pushes it off the shelf";
    EXPECT_LT(z.at("green-ball"), 0.3) << "bob's waving hand hits it";
    EXPECT_GT(z.at("yellow-box"), 1.0) << "nobody touches it";
    EXPECT_GT(scene->world().counters().num_contact_ticks, 60U);
    EXPECT_EQ(scene->world().counters().num_strays, 0U);
    EXPECT_EQ(scene->world().counters().num_not_finite, 0U);
}

}  // namespace
}  // namespace atrium::world_server
