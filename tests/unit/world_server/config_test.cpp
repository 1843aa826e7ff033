#include "world_server/config.hpp"

#include "tests/support/source_dir.hpp"
#include "tests/support/world/load_world.hpp"
#include "world_server/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace atrium::world_server {
namespace {

using testing::HasSubstr;

Expected<WorldServerConfig> parse(const std::string& text) {
    WorldServerConfig config;
    config::OptionSet set;
    declare(config, set);
    auto reader = config::TableReader::parse(text, "world.toml");
    if (!reader) return tl::unexpected(reader.error());
    set.read_file(*reader);
    read_world(*reader, config);
    if (const auto read = reader->finish(); !read) return tl::unexpected(read.error());
    if (const auto valid = check(config); !valid) return tl::unexpected(valid.error());
    return config;
}

std::string error_of(const std::string& text) {
    const auto config = parse(text);
    return config ? "no error" : config.error().message;
}

constexpr const char* kBall =
    "[[object]]\nname = \"ball\"\nshape = \"sphere\"\ndiameter_m = 0.2\nmass_kg = 0.4\n";

TEST(WorldConfig, HasAWorkingDefaultForEverything) {
    const auto config = parse("");
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_TRUE(Scene::create(*config));
}

TEST(WorldConfig, ReadsObjectsSitesAndOptions) {
    const auto config = parse(
        "[world]\ntick_hz = 240\nsend_hz = 30\ngravity = [0, 0, -1.62]\n"
        "[bus]\nworld = \"moon\"\n"
        "[[object]]\nname = \"floor\"\nshape = \"plane\"\nsize_m = [4, 3]\nfriction = 0.9\n"
        "[[object]]\nname = \"crate\"\nshape = \"box\"\nsize_m = [0.1, 0.2, 0.3]\nmass_kg = 2\n"
        "colour = [1, 0.5, 0]\nposition_m = [1, 2, 3]\nroll_pitch_yaw_deg = [0, 0, 90]\n"
        "restitution = 0.5\n"
        "[[object]]\nname = \"log\"\nshape = \"capsule\"\ndiameter_m = 0.1\nheight_m = 0.5\n"
        "mass_kg = 1\n"
        "[[site]]\nname = \"alice\"\nposition_m = [-0.9, 0, 0]\nyaw_deg = 180\n");
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_EQ(config->tick_hz, 240.0);
    EXPECT_EQ(config->send_hz, 30.0);
    EXPECT_EQ(config->world.gravity.z(), -1.62);
    EXPECT_EQ(config->bus.world, "moon");
    ASSERT_EQ(config->objects.size(), 3U);
    EXPECT_EQ(config->objects[0].rigid.shape, physics::ObjectShape::kPlane);
    EXPECT_EQ(config->objects[0].rigid.friction, 0.9);
    const WorldObject& crate = config->objects[1];
    EXPECT_EQ(crate.rigid.id, 2U);
    EXPECT_EQ(crate.rigid.size_m, Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(crate.look.colour, Eigen::Vector3d(1, 0.5, 0));
    EXPECT_EQ(crate.rigid.restitution, 0.5);
    const Eigen::Vector3d turned = crate.rigid.world_from_object * Eigen::Vector3d(1, 0, 0);
    EXPECT_LT((turned - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
    EXPECT_EQ(config->objects[2].rigid.size_m, Eigen::Vector3d(0.1, 0.1, 0.5));
    ASSERT_EQ(config->placements.size(), 1U);
    const Eigen::Vector3d ahead = config->placements[0].world_from_site * Eigen::Vector3d(1, 0, 0);
    EXPECT_LT((ahead - Eigen::Vector3d(-1.9, 0, 0)).norm(), 1e-12);
}

TEST(WorldConfig, ErrorsNameFileLineKeyAndWhatIsAllowed) {
    const std::string ball = kBall;
    const struct {
        std::string text;
        std::vector<std::string> named;
    } cases[] = {
        {"[world]\ntick_hz = 5\n", {"world.toml:2", "world.tick_hz", "30", "5"}},
        {"[world]\nsend_hz = 500\n", {"world.toml:2: world.send_hz", "world.tick_hz"}},
        {"[world]\ntick_hz = 50\n",
         {"world.toml:2: world.send_hz: must not exceed world.tick_hz (50)"}},
        {"[world]\nmodels = \"m\"\n[[object]]\nname = \"a\"\nshape = \"convex\"\n"
         "model = \"../a.obj\"\n",
         {"world.toml:6", "the folder of models, m (world.models)"}},
        {"[world]\ngravity = [0, 0]\n", {"world.toml:2", "gravity"}},
        {"[world]\nspeed = 1\n", {"world.toml:2", "speed"}},
        {ball + "bounce = 1\n", {"world.toml:6", "bounce"}},
        {ball + "restitution = 2\n", {"world.toml:6", "restitution"}},
        {ball + "colour = [0, 0, 7]\n", {"world.toml:6", "colour"}},
        {ball + kBall, {"world.toml:7", "name", "unique"}},
        {"[[object]]\nshape = \"sphere\"\n", {"world.toml", "name", "missing"}},
        {"[[object]]\nname = \"a b\"\nshape = \"plane\"\n", {"world.toml:2", "name"}},
        {"[[object]]\nname = \"a\"\nshape = \"egg\"\n", {"world.toml:3", "shape", "capsule"}},
        {"[[object]]\nname = \"a\"\nshape = \"box\"\nmass_kg = 1\n", {"size_m", "missing"}},
        {"[[object]]\nname = \"a\"\nshape = \"box\"\nsize_m = [1, 1, 1]\n", {"mass_kg", "missing"}},
        {"[[object]]\nname = \"a\"\nshape = \"sphere\"\ndiameter_m = 0.1\nmass_kg = 900\n",
         {"world.toml:5", "mass_kg", "0.000524 to 15.7 kg (a density of 1 to 30000", "0 for"}},
        {"[[object]]\nname = \"a\"\nshape = \"sphere\"\ndiameter_m = 50\nmass_kg = 900\n",
         {"world.toml:4", "diameter_m", "20 m"}},
        {"[[site]]\nname = \"alice\"\n", {"position_m", "missing"}},
        {"[[site]]\nname = \"a\"\nposition_m = [0,0,0]\n[[site]]\nname = \"a\"\nposition_m = "
         "[1,0,0]\n",
         {"world.toml:5", "name", "unique"}},
    };
    for (const auto& c : cases) {
        const std::string message = error_of(c.text);
        for (const std::string& part : c.named) EXPECT_THAT(message, HasSubstr(part)) << c.text;
    }
}

TEST(WorldConfig, RefusesTooManyObjects) {
    EXPECT_THAT(error_of(std::string("[world]\nmax_objects = 1\n") + kBall +
                         "[[object]]\nname = \"floor\"\nshape = \"plane\"\n"),
                HasSubstr("world.toml:2: world.max_objects: must be at least the 2 objects "
                          "described, got 1 (default 256, at most 2048)"));
    std::string balls;
    for (int i = 0; i < 257; ++i) {
        balls += "[[object]]\nname = \"ball" + std::to_string(i) +
                 "\"\nshape = \"sphere\"\ndiameter_m = 0.2\nmass_kg = 0.4\n";
    }
    EXPECT_THAT(error_of(balls), HasSubstr("world.toml:1: world.max_objects: must be at least the"))
        << "the file does not set the key";
}

TEST(WorldConfig, OfEveryDeliveredWorldIsValid) {
    int num_worlds = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(atrium::test::source_dir() + "/deploy/worlds")) {
        if (entry.path().extension() != ".toml") continue;
        ++num_worlds;
        const auto config = test_support::load_world(entry.path());
        ASSERT_TRUE(config) << config.error().message;
        auto scene = Scene::create(*config);
        ASSERT_TRUE(scene) << scene.error().message;

        // untouched objects stay in the world and come to rest, or nearly so
        for (int i = 0; i < 600; ++i) scene->world().tick();
        EXPECT_EQ(scene->world().counters().num_strays, 0U) << entry.path();
        bus::SceneState state;
        scene->get_state("w", {}, state);
        for (const bus::ObjectState& object : state.objects) {
            EXPECT_LT(object.linear_velocity.norm(), 0.3) << entry.path() << " " << object.object;
        }
    }
    EXPECT_GE(num_worlds, 2);
}

}  // namespace
}  // namespace atrium::world_server
