#include "world_server/saved_worlds.hpp"

#include "tests/support/source_dir.hpp"
#include "tests/support/world/load_world.hpp"
#include "world_server/description/doubts.hpp"
#include "world_server/description/world_text.hpp"
#include "world_server/scene.hpp"
#include "world_server/state_saver.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>

namespace atrium::world_server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SavedWorldFiles : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("atrium-saved-" + std::to_string(getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path folder_;
};

void expect_same(const bus::SceneObject& a, const bus::SceneObject& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.shape, b.shape) << a.name;
    EXPECT_TRUE(a.size_m.head<2>().isApprox(b.size_m.head<2>(), 1e-12)) << a.name;
    EXPECT_NEAR(a.mass_kg, b.mass_kg, 1e-12 * a.mass_kg) << a.name;
    EXPECT_EQ(a.friction, b.friction) << a.name;
    EXPECT_EQ(a.restitution, b.restitution) << a.name;
    EXPECT_EQ(a.colour, b.colour) << a.name;
    EXPECT_EQ(a.model, b.model) << a.name;
    EXPECT_EQ(a.model_scale, b.model_scale) << a.name;
    EXPECT_EQ(a.texture, b.texture) << a.name;
    const geometry::RigidTransform& pose = a.world_from_object;
    EXPECT_LT((pose.translation - b.world_from_object.translation).norm(), 2e-6) << a.name;
    EXPECT_LT(pose.rotation.angularDistance(b.world_from_object.rotation), 1e-7) << a.name;
}

void expect_same(const physics::Joint& a, const physics::Joint& b) {
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.a, b.a);
    EXPECT_EQ(a.b, b.b);
    EXPECT_TRUE(a.anchor_m.isApprox(b.anchor_m, 1e-12));
    EXPECT_TRUE(a.anchor_b_m.isApprox(b.anchor_b_m, 1e-12));
    if (a.kind != physics::JointKind::kSpring) {
        EXPECT_LT((a.axis - b.axis).norm(), 1e-12);
    }
    EXPECT_EQ(a.collides, b.collides);
    EXPECT_EQ(a.pulls_only, b.pulls_only);
    EXPECT_EQ(a.damping, b.damping);
    EXPECT_EQ(a.stiffness_npm, b.stiffness_npm);
    EXPECT_EQ(a.rest_length_m, b.rest_length_m);
    EXPECT_EQ(a.force_max, b.force_max);
    EXPECT_EQ(a.motor_max, b.motor_max);
    EXPECT_NEAR(a.motor_speed, b.motor_speed, 1e-12);
    EXPECT_NEAR(a.swing_rad.value_or(-1), b.swing_rad.value_or(-1), 1e-12);
    EXPECT_NEAR(a.twist_rad.value_or(-1), b.twist_rad.value_or(-1), 1e-12);
    ASSERT_EQ(a.limits.has_value(), b.limits.has_value());
    for (std::size_t i = 0; a.limits && i < 2; ++i)
        EXPECT_NEAR((*a.limits)[i], (*b.limits)[i], 1e-12);
}

void expect_same(const WorldSoftObject& a, const WorldSoftObject& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.object.shape, b.object.shape);
    EXPECT_EQ(a.object.size_m, b.object.size_m) << a.name;
    EXPECT_EQ(a.object.span_m, b.object.span_m) << a.name;
    EXPECT_EQ(a.object.model.vertices, b.object.model.vertices) << a.name;
    EXPECT_EQ(a.object.mass_kg, b.object.mass_kg) << a.name;
    EXPECT_EQ(a.object.stiffness, b.object.stiffness) << a.name;
    EXPECT_EQ(a.object.damping_hz, b.object.damping_hz) << a.name;
    ASSERT_EQ(a.object.pins.size(), b.object.pins.size()) << a.name;
    for (std::size_t i = 0; i < a.object.pins.size(); ++i) {
        EXPECT_EQ(a.object.pins[i].place, b.object.pins[i].place) << a.name;
        EXPECT_EQ(a.object.pins[i].object_id, b.object.pins[i].object_id) << a.name;
    }
}

TEST_F(SavedWorldFiles, AllDeliveredWorldsReturnAsTheyWere) {
    const SavedWorldsFolder folder(folder_, 10);
    ASSERT_TRUE(folder.open());
    for (const char* name : {"demo", "playroom", "ballpit", "dominoes", "puppet", "curtain"}) {
        SCOPED_TRACE(name);
        const auto config = test_support::load_world(
            fs::path(atrium::test::source_dir()) / "deploy/worlds" / (std::string(name) + ".toml"));
        ASSERT_TRUE(config) << config.error().message;
        const auto scene = Scene::create(*config);
        ASSERT_TRUE(scene) << scene.error().message;
        ASSERT_TRUE(folder.save(name, world_text(*config, *scene, folder_)));
        const auto loaded = folder.load(name, *config);
        ASSERT_TRUE(loaded) << loaded.error().message;
        const auto again = Scene::create(*loaded);
        ASSERT_TRUE(again) << again.error().message;
        const auto before = scene->objects();
        const auto after = again->objects();
        ASSERT_EQ(before.size(), after.size());
        for (std::size_t i = 0; i < before.size(); ++i) expect_same(before[i], after[i]);
        ASSERT_EQ(config->joints.size(), loaded->joints.size());
        for (std::size_t i = 0; i < config->joints.size(); ++i)
            expect_same(config->joints[i], loaded->joints[i]);
        ASSERT_EQ(config->soft.size(), loaded->soft.size());
        for (std::size_t i = 0; i < config->soft.size(); ++i)
            expect_same(config->soft[i], loaded->soft[i]);
        EXPECT_EQ(config->scenery.size(), loaded->scenery.size());
        EXPECT_EQ(config->world.gravity, loaded->world.gravity);
        EXPECT_EQ(config->world.leaving, loaded->world.leaving);
        EXPECT_EQ(box_of(config->world).min, box_of(loaded->world).min);
        // a file for world_server as it is, with nothing else
        EXPECT_TRUE(test_support::load_world(folder_ / (std::string(name) + ".toml")));
        // and the same text when it is saved again
        EXPECT_EQ(world_text(*loaded, *again, folder_), world_text(*config, *scene, folder_));
    }
    const bus::SavedWorlds list = folder.list("hall");
    ASSERT_EQ(list.worlds.size(), 6U);
    EXPECT_TRUE(list.is_on);
    EXPECT_EQ(list.worlds.front().name, "ballpit");
    EXPECT_GT(list.worlds.front().num_objects, 80U);
    EXPECT_NEAR(milliseconds(Timestamp::now() - list.worlds.front().time), 0.0, 60'000.0);
}

// Also if one of the two is gone.
TEST_F(SavedWorldFiles, KeepARopeBetweenTwoObjects) {
    fs::create_directories(folder_);
    const auto post = [](const char* name, const char* x) {
        return std::string("[[object]]\nname = \"") + name +
               "\"\nshape = \"box\"\nsize_m = [0.3, 0.3, 0.9]\nmass_kg = 8\nposition_m = [" + x +
               ", 0, 0.45]\n";
    };
    std::ofstream(folder_ / "world.toml")
        << post("a", "-0.7") << post("b", "0.7")
        << "[[soft]]\nname = \"rope\"\nshape = \"rope\"\nlength_m = 1.5\nspan_m = 1.4\n"
           "diameter_m = 0.03\nmass_kg = 0.1\nposition_m = [0, 0, 0.85]\n"
           "tied = [\"end\", \"start\"]\ntied_to = [\"b\", \"a\"]\n";
    const auto config = test_support::load_world(folder_ / "world.toml");
    ASSERT_TRUE(config) << config.error().message;
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene) << scene.error().message;
    const std::string text = world_text(*config, *scene, folder_);
    EXPECT_THAT(text, HasSubstr("\ntied_to = [\"b\", \"a\"]\ntied = [\"end\", \"start\"]\n"));
    std::ofstream(folder_ / "again.toml") << text;
    const auto again = test_support::load_world(folder_ / "again.toml");
    ASSERT_TRUE(again) << again.error().message;
    ASSERT_EQ(again->soft.size(), 1U);
    expect_same(again->soft[0], config->soft[0]);
    EXPECT_EQ(again->soft[0].object.pins[0].object_id, 2U);
    ASSERT_TRUE(scene->world().remove(1));
    EXPECT_THAT(world_text(*config, *scene, folder_),
                HasSubstr("\ntied_to = \"b\"\ntied = [\"end\"]\n"));
}

TEST(SceneEdits, RefuseATooLargeModelByItsScale) {
    const auto config = test_support::load_world(fs::path(atrium::test::source_dir()) /
                                                 "deploy/worlds/playroom.toml");
    ASSERT_TRUE(config);
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene);
    geometry::TriangleMesh wide;
    wide.vertices = {{0, 0, 0}, {30, 0, 0}, {0, 2, 0}, {0, 0, 1}};
    wide.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    bus::SceneEdit add;
    add.sender = "eve";
    add.object.name = "ship";
    add.object.shape = bus::Shape::kConvex;
    add.object.model = "models/ship.obj";
    add.object.mass_kg = 100.0;
    const auto refused = scene->edit(
        add, std::make_shared<const std::vector<geometry::TriangleMesh>>(std::vector{wide}));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message,
              "add: the model must be 0.01 m to 20 m, it is 30 x 2 x 1 m: change its scale");
}

TEST_F(SavedWorldFiles, SaveWhereThingsAreNow) {
    const auto config = test_support::load_world(fs::path(atrium::test::source_dir()) /
                                                 "deploy/worlds/playroom.toml");
    ASSERT_TRUE(config);
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene);
    bus::SceneEdit add;
    add.sender = "eve";
    add.object.name = "box";
    add.object.size_m.setConstant(0.2);
    add.object.mass_kg = 1.0;
    // as in a message, where numbers have the precision of a float
    add.object.friction = static_cast<double>(0.9f);
    add.object.colour = Eigen::Vector3f(0.1f, 0.2f, -0.0f).cast<double>();
    add.object.world_from_object.translation = {0.5, 0.25, 2.0};
    add.object.world_from_object.rotation =
        Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(scene->edit(add, nullptr));
    const auto before = scene->objects();
    const SavedWorldsFolder folder(folder_, 10);
    ASSERT_TRUE(folder.open());
    const std::string text = world_text(*config, *scene, folder_);
    EXPECT_THAT(text, HasSubstr("\nfriction = 0.9\n"));
    EXPECT_THAT(text, HasSubstr("\ncolour = [0.1, 0.2, 0]\n"));
    ASSERT_TRUE(folder.save("now", text));
    const auto loaded = folder.load("now", *config);
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->objects.size(), before.size());
    const WorldObject& last = loaded->objects.back();
    EXPECT_LT((last.rigid.world_from_object.translation - Eigen::Vector3d(0.5, 0.25, 2.0)).norm(),
              2e-6);
    EXPECT_LT(last.rigid.world_from_object.rotation.angularDistance(
                  add.object.world_from_object.rotation),
              1e-6);
    EXPECT_NE(last.name, loaded->objects[before.size() - 2].name) << "names must differ in a file";
}

TEST_F(SavedWorldFiles, KeepWhatLiesInADent) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "world.toml")
        << "[[object]]\nname = \"floor\"\nshape = \"plane\"\nsize_m = [5, 5]\n"
           "[[object]]\nname = \"anvil\"\nshape = \"box\"\nsize_m = [0.2, 0.1, 0.1]\n"
           "mass_kg = 20\nposition_m = [0, 0, 0.22]\n"
           "[[soft]]\nname = \"cushion\"\nshape = \"box\"\nsize_m = [0.5, 0.5, 0.16]\n"
           "material = \"foam\"\nposition_m = [0, 0, 0.085]\n";
    const auto config = test_support::load_world(folder_ / "world.toml");
    ASSERT_TRUE(config) << config.error().message;
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene);
    const auto anvil_z_m = [](Scene& of) { return of.world().pose_of(2)->translation.z(); };
    for (int i = 0; i < 960; ++i) scene->world().tick();
    const double at_rest_m = anvil_z_m(*scene);
    ASSERT_LT(at_rest_m, 0.20) << "it lies in a dent";
    const SavedWorldsFolder folder(folder_, 10);
    ASSERT_TRUE(folder.save("dent", world_text(*config, *scene, folder_)));
    const auto loaded = folder.load("dent", *config);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_TRUE(doubts_about(*loaded, 120.0).empty()) << doubts_about(*loaded, 120.0).front();
    auto again = Scene::create(*loaded);
    ASSERT_TRUE(again) << again.error().message;
    std::vector<Eigen::Vector3f> before, after;
    ASSERT_TRUE(scene->world().get_soft_nodes(3, before));
    for (const bool is_reset : {false, true}) {
        if (is_reset) again->world().reset();
        for (int i = 0; i < 360; ++i) again->world().tick();
        EXPECT_NEAR(anvil_z_m(*again), at_rest_m, 0.005) << is_reset;
        ASSERT_TRUE(again->world().get_soft_nodes(3, after));
        ASSERT_EQ(before.size(), after.size());
        for (std::size_t i = 0; i < before.size(); ++i)
            EXPECT_LT((before[i] - after[i]).norm(), 0.01F) << i;
    }
}

TEST_F(SavedWorldFiles, KeepAHammock) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "world.toml")
        << "[[soft]]\nname = \"hammock\"\nshape = \"cloth\"\nsize_m = [2.0, 1.0]\nspan_m = 1.7\n"
           "mass_kg = 0.6\nposition_m = [0, 0, 1]\nroll_pitch_yaw_deg = [90, 0, 0]\n"
           "pins = [\"left\", \"right\"]\n";
    const auto config = test_support::load_world(folder_ / "world.toml");
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_EQ(config->soft.front().object.span_m, 1.7);
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene) << scene.error().message;
    const SavedWorldsFolder folder(folder_, 10);
    ASSERT_TRUE(folder.open());
    ASSERT_TRUE(folder.save("now", world_text(*config, *scene, folder_)));
    const auto loaded = folder.load("now", *config);
    ASSERT_TRUE(loaded) << loaded.error().message;
    expect_same(config->soft.front(), loaded->soft.front());
}

TEST_F(SavedWorldFiles, RefuseNodesOfAnotherShape) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "world.toml")
        << "[[soft]]\nname = \"cushion\"\nshape = \"box\"\nsize_m = [0.5, 0.5, 0.16]\n"
           "mass_kg = 1\nposition_m = [0, 0, 0.085]\nnodes_m = [0, 0, 1, 0, 0, 2]\n";
    const auto config = test_support::load_world(folder_ / "world.toml");
    ASSERT_FALSE(config);
    EXPECT_THAT(config.error().message, HasSubstr("world.toml:7: soft[0].nodes_m"));
    EXPECT_THAT(config.error().message, HasSubstr("numbers"));
    std::ofstream(folder_ / "world.toml")
        << "[[soft]]\nname = \"rope\"\nshape = \"rope\"\nlength_m = 0.2\ndiameter_m = 0.02\n"
           "spacing_m = 0.1\nmass_kg = 0.1\nposition_m = [0, 0, 1]\n"
           "nodes_m = [500, 0, 1, 500.1, 0, 1, 500.2, 0, 1]\n";
    const auto outside = test_support::load_world(folder_ / "world.toml");
    ASSERT_FALSE(outside);
    EXPECT_THAT(outside.error().message,
                HasSubstr("soft object 'rope': must start inside the world's bounds"));
}

TEST_F(SavedWorldFiles, RefuseNamesLimitsAndDamage) {
    const WorldServerConfig config;
    const SavedWorldsFolder off({}, 2);
    EXPECT_THAT(off.save("a", "").error().message, HasSubstr("world.saved_folder"));
    EXPECT_FALSE(off.list("hall").is_on);
    const SavedWorldsFolder folder(folder_, 2);
    ASSERT_TRUE(folder.open());
    for (const char* name : {"", "../up", "a/b", ".hidden", "..", "a b", "/etc/passwd"}) {
        EXPECT_THAT(folder.save(name, "x").error().message, HasSubstr("1 to 63 characters"))
            << name;
        EXPECT_FALSE(folder.load(name, config)) << name;
    }
    EXPECT_TRUE(fs::is_empty(folder_));
    EXPECT_THAT(folder.load("none", config).error().message,
                HasSubstr("there is no saved world 'none'"));
    ASSERT_TRUE(folder.save("a", "[world]\n"));
    ASSERT_TRUE(folder.save("b", "[world]\nhalf = \n"));
    EXPECT_THAT(folder.save("c", "").error().message, HasSubstr("world.max_saved"));
    EXPECT_TRUE(folder.save("a", "[[object]]\nshape = 'box'\n")) << "over itself";
    EXPECT_THAT(folder.load("a", config).error().message, HasSubstr("a.toml"));
    EXPECT_THAT(folder.load("b", config).error().message, HasSubstr("b.toml"));
}

// A disk without room, as a limit on the size of files.
TEST_F(SavedWorldFiles, AFullDiskKeepsTheOldFileAndTellsWhy) {
    const SavedWorldsFolder folder(folder_, 4);
    ASSERT_TRUE(folder.open());
    ASSERT_TRUE(folder.save("a", "[world]\n"));
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit low = before;
    low.rlim_cur = 1000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &low), 0);
    const auto saved = folder.save("a", std::string(5000, '#'));
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old_handler);
    ASSERT_FALSE(saved);
    EXPECT_THAT(saved.error().message, HasSubstr("cannot write"));
    std::ifstream in(folder_ / "a.toml");
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line, "[world]");
}

// The state of a saved world that was loaded goes on, unless the world file was changed since.
TEST_F(SavedWorldFiles, StateOfALoadedWorldHoldsForItsWorldFile) {
    fs::create_directories(folder_);
    const auto file = [&](const std::string& name) {
        std::ofstream(folder_ / "room.toml") << "[[object]]\nname = \"" << name
                                             << "\"\nshape = \"box\"\nsize_m = [1, 1, 1]\n"
                                                "mass_kg = 0\n";
        WorldServerConfig config = *test_support::load_world(folder_ / "room.toml");
        config.saved_folder = folder_ / "saved";
        config.state_file = folder_ / "world.state";
        config.world_file_hash = Scene::create(config)->description_hash();
        return config;
    };
    const WorldServerConfig config = file("shelf");
    const SavedWorldsFolder saved(config.saved_folder, 8);
    ASSERT_TRUE(saved.open());
    ASSERT_TRUE(saved.save("tour",
                           "[[object]]\nname = \"bust\"\nshape = \"sphere\"\ndiameter_m = 0.2\n"
                           "mass_kg = 3\n"));
    const auto loaded = saved.load("tour", config);
    ASSERT_TRUE(loaded) << loaded.error().message;
    auto scene = Scene::create(*loaded);
    ASSERT_TRUE(scene);
    SavedWorld state;
    scene->save(state);
    ASSERT_TRUE(StateSaver(config.state_file).save(state));

    const auto back = load_scene(config);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ((*back)->loaded(), "tour");
    EXPECT_EQ((*back)->objects().front().name, "bust");
    const auto changed = load_scene(file("bench"));
    ASSERT_FALSE(changed);
    EXPECT_THAT(changed.error().message,
                testing::AllOf(HasSubstr("saved world 'tour'"),
                               HasSubstr("the world file was changed since"),
                               HasSubstr("kept as")));
    EXPECT_FALSE(*load_scene(config)) << "no file must remain";
}

}  // namespace
}  // namespace atrium::world_server
