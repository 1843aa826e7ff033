// The [[soft]] tables of a world file.
#include "world_server/soft_config.hpp"

#include "world_server/config.hpp"
#include "world_server/scene.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace atrium::world_server {
namespace {

std::string error_of(const std::string& toml) {
    auto reader = config::TableReader::parse(toml, "w.toml");
    if (!reader) return reader.error().message;
    WorldServerConfig config;
    read_world(*reader, config);
    const auto finished = reader->finish();
    return finished ? "" : finished.error().message;
}

const std::string kCloth = R"([[soft]]
name = "sheet"
shape = "cloth"
size_m = [1.0, 1.0]
mass_kg = 0.2
)";

TEST(SoftConfig, NamesFileLineAndKeyOfWhatIsWrong) {
    EXPECT_EQ(error_of(kCloth), "");
    const auto expect_error = [](const std::string& toml, const std::string& part) {
        const std::string error = error_of(toml);
        EXPECT_NE(error.find("w.toml:"), std::string::npos) << error;
        EXPECT_NE(error.find(part), std::string::npos) << error;
    };
    expect_error(kCloth + "pins = [\"middle\"]\n", "pins");
    expect_error(kCloth + "spacing_m = 0.01\n", "spacing_m");
    expect_error(kCloth + "stiffness = 2.0\n", "stiffness");
    expect_error(kCloth + "tied_to = \"nobody\"\ntied = [\"top\"]\n", "tied_to");
    expect_error(kCloth + "softness = 2.0\n", "softness");
    expect_error(kCloth + kCloth, "name");
    expect_error("[[soft]]\nname = \"b\"\nshape = \"ball\"\ndiameter_m = 0.001\nmass_kg = 1.0\n",
                 "diameter_m");
}

TEST(SoftConfig, ReadsTheWorldWithTheCurtain) {
    const auto file = std::filesystem::path(ATRIUM_SOURCE_DIR) / "deploy/worlds/curtain.toml";
    auto reader = config::TableReader::load(file);
    ASSERT_TRUE(reader.has_value());
    WorldServerConfig config;
    read_world(*reader, config);
    ASSERT_EQ(config.soft.size(), 4U);
    EXPECT_EQ(config.soft[0].name, "curtain-left");
    EXPECT_EQ(config.soft[0].object.id, config.objects.size() + 1);
    EXPECT_EQ(config.soft[3].object.pins.size(), 2U);
    EXPECT_EQ(config.soft[3].object.pins[1].object_id, 3U);  // the weight

    auto scene = Scene::create(config);
    ASSERT_TRUE(scene.has_value()) << scene.error().message;
    for (int i = 0; i < 600; ++i) scene->world().tick();
    std::vector<physics::SoftState> states;
    scene->world().get_soft_states(states);
    ASSERT_EQ(states.size(), 4U);
    for (const physics::SoftState& state : states) {
        for (const Eigen::Vector3f& v : state.velocities) EXPECT_LT(v.norm(), 0.3F);
    }
    EXPECT_EQ(scene->world().counters().num_torn, 0U);
}

}  // namespace
}  // namespace atrium::world_server
