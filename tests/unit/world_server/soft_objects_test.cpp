// The [[soft]] tables of a world file.
#include "world_server/description/soft_objects.hpp"

#include "tests/support/source_dir.hpp"
#include "world_server/config.hpp"
#include "world_server/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string soft_error_of(const std::string& toml) {
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

TEST(SoftConfig, NamesFileLineAndKeyOfAnError) {
    EXPECT_EQ(soft_error_of(kCloth), "");
    EXPECT_EQ(soft_error_of(kCloth + "span_m = 0.8\n"), "");
    const auto expect_error = [](const std::string& toml, const std::string& part) {
        const std::string error = soft_error_of(toml);
        EXPECT_NE(error.find("w.toml:"), std::string::npos) << error;
        EXPECT_NE(error.find(part), std::string::npos) << error;
    };
    expect_error(kCloth + "span_m = 1.2\n",
                 "w.toml:6: soft[0].span_m: must be 0.01 m to the width of the cloth");
    expect_error(kCloth + "pins = [\"middle\"]\n", "must be of top, bottom, left, right");
    expect_error(kCloth + "pins = [\"start\"]\n", "must be of top, bottom, left, right");
    const std::string rope =
        "[[soft]]\nname = \"r\"\nshape = \"rope\"\nlength_m = 1\ndiameter_m = 0.02\nmass_kg = "
        "0.2\n";
    expect_error(rope + "pins = [\"top\"]\n", "pins: must be of start, end for a rope");
    expect_error(
        "[[soft]]\nname = \"b\"\nshape = \"ball\"\ndiameter_m = 0.3\nmass_kg = 1\n"
        "pins = [\"top\"]\n",
        "pins: must be left out: only a cloth and a rope can be attached");
    expect_error(kCloth + "spacing_m = 0.01\n", "spacing_m");
    expect_error(kCloth + "stiffness = 2.0\n", "stiffness");
    expect_error(kCloth + "tied_to = \"nobody\"\ntied = [\"top\"]\n", "tied_to");
    expect_error("[[object]]\nname = \"mast\"\nshape = \"plane\"\n" + kCloth +
                     "tied_to = \"msat\"\ntied = [\"top\"]\n",
                 "must be the name of an [[object]] (did you mean mast?)");
    expect_error(kCloth + "tied = [\"top\"]\n", "needs tied_to");
    const std::string masts =
        "[[object]]\nname = \"a\"\nshape = \"plane\"\n[[object]]\nname = \"b\"\nshape = "
        "\"plane\"\n";
    const auto tied = [&](const std::string& soft, const std::string& to, const std::string& at) {
        return masts + soft + "tied_to = [" + to + "]\ntied = [" + at + "]\n";
    };
    const std::string ends = R"("start", "end")";
    EXPECT_EQ(soft_error_of(tied(rope, R"("a", "b")", ends)), "");
    EXPECT_EQ(soft_error_of(tied(rope, R"("a")", ends)), "");
    EXPECT_EQ(soft_error_of(tied(kCloth, R"("a")", R"("top")")), "");
    expect_error(tied(kCloth, R"("a", "b")", R"("left", "right")"),
                 "tied_to: must be one name: only a rope can be tied to two objects, one per end");
    expect_error(tied(rope, R"("a", "b", "a")", ends),
                 "tied_to: must be one name, or two: those of the objects at the two ends");
    expect_error(tied(rope, R"("a", "a")", ends), "tied_to: must be two different objects; if");
    expect_error(tied(rope, R"("a", "c")", ends), "tied_to: must be the name of an [[object]]");
    expect_error(tied(rope, "", ends), "tied_to: must be the name of an [[object]]");
    for (const char* at : {R"("start")", R"("end", "end")", ""})
        expect_error(tied(rope, R"("a", "b")", at), "must be one name, unless tied has both ends");
    expect_error(masts + rope + "tied_to = [\"a\", \"b\"]\n", "tied: ");
    expect_error(masts + rope + "tied_to = 3\ntied = [\"end\"]\n", "tied_to: ");
    expect_error(masts + rope + "tied_to = [3, 4]\ntied = [\"end\"]\n", "tied_to: ");
    expect_error(kCloth + "softness = 2.0\n", "softness");
    expect_error(kCloth + kCloth, "name");
    expect_error("[[soft]]\nname = \"b\"\nshape = \"ball\"\ndiameter_m = 0.001\nmass_kg = 1.0\n",
                 "diameter_m");
}

TEST(SoftConfig, UsesTheValuesOfTheMaterial) {
    const std::string text =
        "[[material]]\nname = \"down\"\ndensity_kg_per_m3 = 20.0\nfriction = 0.9\n"
        "colour = [0.1, 0.2, 0.3]\n"
        "[[soft]]\nname = \"a\"\nshape = \"box\"\nsize_m = [0.5, 0.4, 0.1]\nmaterial = \"down\"\n"
        "[[soft]]\nname = \"b\"\nshape = \"ball\"\ndiameter_m = 0.3\nmaterial = \"down\"\n"
        "mass_kg = 0.7\nfriction = 0.2\ncolour = [1, 1, 1]\n"
        "[[soft]]\nname = \"c\"\nshape = \"rope\"\nlength_m = 2.0\ndiameter_m = 0.02\n"
        "density_kg_per_m3 = 300\n";
    auto reader = config::TableReader::parse(text, "w.toml");
    ASSERT_TRUE(reader.has_value());
    WorldServerConfig config;
    read_world(*reader, config);
    const auto finished = reader->finish();
    ASSERT_TRUE(finished.has_value()) << finished.error().message;
    ASSERT_EQ(config.soft.size(), 3U);
    EXPECT_NEAR(config.soft[0].object.mass_kg, 0.4, 1e-9);
    EXPECT_EQ(config.soft[0].object.friction, 0.9);
    EXPECT_EQ(config.soft[0].colour, Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(config.soft[1].object.mass_kg, 0.7);
    EXPECT_EQ(config.soft[1].object.friction, 0.2);
    EXPECT_EQ(config.soft[1].colour, Eigen::Vector3d(1, 1, 1));
    EXPECT_NEAR(config.soft[2].object.mass_kg, 300 * 2.0 * 3.14159265 * 0.01 * 0.01, 1e-6);
}

class SoftModelFile : public testing::Test {
protected:
    SoftModelFile()
        : folder_(std::filesystem::temp_directory_path() /
                  ("atrium_soft_" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(folder_);
        // a wedge as exporters write it: each face has its own vertices
        put("wedge.obj",
            "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 0\nv 1 0 0\nv 0 0 1\n"
            "v 0 0 0\nv 0 0 1\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
            "f 1 2 3\nf 4 5 6\nf 7 8 9\nf 10 11 12\n");
        put("open.obj", "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\n");
        put("inside_out.obj",
            "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\nf 1 4 3\nf 1 2 4\nf 3 4 2\n");
        std::string many = "";
        for (int i = 0; i < 1600; ++i) many += "v " + std::to_string(0.01 * i) + " 0 0\n";
        many += "v 0 1 0\n";
        for (int i = 1; i < 1600; ++i)
            many += "f " + std::to_string(i) + " " + std::to_string(i + 1) + " 1601\n";
        put("many.obj", many);
    }
    ~SoftModelFile() override { std::filesystem::remove_all(folder_); }

    void put(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }
    // The text of a world with this [[soft]] of shape model.
    std::string error_of_model(const std::string& keys,
                               WorldServerConfig& config,
                               const std::string& mass = "mass_kg = 1\n") const {
        put("world.toml", "[[soft]]\nname = \"m\"\nshape = \"model\"\n" + mass + keys);
        auto reader = config::TableReader::load(folder_ / "world.toml");
        if (!reader) return reader.error().message;
        read_world(*reader, config);
        const auto finished = reader->finish();
        return finished ? "" : finished.error().message;
    }
    std::filesystem::path folder_;
};

TEST_F(SoftModelFile, HasOneNodePerVertexPosition) {
    WorldServerConfig config;
    ASSERT_EQ(error_of_model("model = \"wedge.obj\"\nscale = 0.5\n", config), "");
    const physics::SoftObject& object = config.soft.at(0).object;
    EXPECT_EQ(object.shape, physics::SoftShape::kModel);
    EXPECT_EQ(object.model.vertices.size(), 4U);
    EXPECT_EQ(object.model.triangles.size(), 4U);
    EXPECT_NEAR(physics::volume_m3(object), 0.125 / 6.0, 1e-9);
}

TEST_F(SoftModelFile, IsRefusedWithFileLineAndKey) {
    const auto expect_error =
        [&](const std::string& keys, const std::string& line_and_key, const std::string& part) {
            WorldServerConfig config;
            const std::string error = error_of_model(keys, config);
            EXPECT_NE(error.find("world.toml:" + line_and_key), std::string::npos) << error;
            EXPECT_NE(error.find(part), std::string::npos) << error;
        };
    expect_error("model = \"none.obj\"\n", "5: ", "no such file");
    expect_error("model = \"open.obj\"\n", "5: ", "must be closed");
    expect_error("model = \"inside_out.obj\"\n", "5: ", "face outwards");
    expect_error("model = \"many.obj\"\n", "5: ", "1500 distinct vertices, many.obj has 1601");
    expect_error("model = \"wedge.obj\"\nscale = 0.001\n", "6: ", "scale");
    expect_error("", "1: ", "model");
}

TEST_F(SoftModelFile, IsBlamedBeforeTheMassOfItsMaterial) {
    WorldServerConfig config;
    const auto error_of = [&](const std::string& keys) {
        return error_of_model(keys, config, "material = \"foam\"\n");
    };
    EXPECT_THAT(error_of("model = \"open.obj\"\n"), HasSubstr("5: soft[0].model: must be closed"));
    EXPECT_THAT(error_of("model = \"inside_out.obj\"\n"), HasSubstr("5: soft[0].model: must face"));
    EXPECT_THAT(error_of("model = \"wedge.obj\"\nscale = 100\n"),
                AllOf(HasSubstr("6: soft[0].scale: must make the model reach at most 20 m"),
                      HasSubstr("the model is 100 x 100 x 100 m (scale = 0.01 reads centim")));
    EXPECT_THAT(error_of("model = \"wedge.obj\"\nscale = 10\n"),
                AllOf(HasSubstr("4: soft[0].material: must be 0.001 kg to 100 kg"),
                      HasSubstr("its volume of 167 m^3 gives 6667 kg: write mass_kg"),
                      HasSubstr("the model is 10 x 10 x 10 m (scale")));
    EXPECT_EQ(error_of("model = \"wedge.obj\"\n"), "");
}

TEST(SoftConfig, ReadsTheWorldWithTheCurtain) {
    const auto file =
        std::filesystem::path(atrium::test::source_dir()) / "deploy/worlds/curtain.toml";
    auto reader = config::TableReader::load(file);
    ASSERT_TRUE(reader.has_value());
    WorldServerConfig config;
    read_world(*reader, config);
    ASSERT_EQ(config.soft.size(), 5U);
    EXPECT_EQ(config.soft[0].name, "curtain-left");
    EXPECT_EQ(config.soft[0].object.id, config.objects.size() + 1);
    EXPECT_EQ(config.soft[3].object.model.vertices.size(), 200U);
    EXPECT_NEAR(config.soft[3].object.mass_kg, 0.44, 0.03) << "of foam";
    EXPECT_EQ(config.soft[4].object.pins.size(), 2U);
    EXPECT_EQ(config.soft[4].object.pins[1].object_id, 3U);  // the weight

    auto scene = Scene::create(config);
    ASSERT_TRUE(scene.has_value()) << scene.error().message;
    for (int i = 0; i < 600; ++i) scene->world().tick();
    std::vector<physics::SoftState> states;
    scene->world().get_soft_states(states);
    ASSERT_EQ(states.size(), 5U);
    for (const physics::SoftState& state : states) {
        for (const Eigen::Vector3f& v : state.velocities) EXPECT_LT(v.norm(), 0.3F);
    }
    EXPECT_EQ(scene->world().counters().num_torn, 0U);
}

}  // namespace
}  // namespace atrium::world_server
