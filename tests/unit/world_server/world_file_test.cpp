#include "tests/support/world/load_world.hpp"
#include "world_server/config.hpp"
#include "world_server/scene.hpp"
#include "world_server/scene_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

// Everything in a world file besides simple objects, and its errors.
namespace atrium::world_server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

class WorldFile : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  ("world_file_" +
                   std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
        fs::remove_all(folder_);
        fs::create_directories(folder_ / "models");
        put("models/corner.obj", std::string("o corner\n") + kTetrahedron);
        put("models/two.obj",
            std::string("o one\n") + kTetrahedron +
                "o two\nv 1 0 0\nv 1.3 0 0\nv 1 0.3 0\nv 1 0 0.3\n"
                "f 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n");
        put("models/flat.obj", "o flat\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        put("models/damaged.obj", "o corner\nv 0 0 0\nv 1 zero 0\nf 1 2 900\n");
        put("models/cut.glb", "glTF\x02");
        put("models/far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
        put("models/paint.png", "any bytes: only viewers look inside");
    }
    void TearDown() override { fs::remove_all(folder_); }

    void put(const std::string& name, const std::string& text) {
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }

    Expected<WorldServerConfig> read(const std::string& text) {
        put("world.toml", text);
        return test_support::load_world(folder_ / "world.toml");
    }

    std::string error_of(const std::string& text) {
        const auto config = read(text);
        return config ? "no error" : config.error().message;
    }

    fs::path folder_;
};

const std::string kCorner =
    "[[object]]\nname = \"corner\"\nshape = \"convex\"\nmodel = \"models/corner.obj\"\n";
const std::string kBall =
    "[[object]]\nname = \"ball\"\nshape = \"sphere\"\ndiameter_m = 0.2\nmass_kg = 0.4\n";

TEST_F(WorldFile, GivesItsFilesFingerprintsForTheViewers) {
    const auto config =
        read("[[material]]\nname = \"clay\"\ntexture = \"models/paint.png\"\n" + kCorner +
             "material = \"clay\"\nmass_kg = 1\n" + kBall +
             "[[scenery]]\nname = \"stage\"\nmodel = \"models/flat.obj\"\n"
             "[[soft]]\nname = \"flag\"\nshape = \"cloth\"\nsize_m = [1, 1]\nmass_kg = 0.2\n"
             "texture = \"models/paint.png\"\nposition_m = [0, 3, 3]\n");
    ASSERT_TRUE(config) << config.error().message;
    const auto of = [this](const char* file) { return fingerprint_of(folder_ / file, 10'000); };
    ASSERT_TRUE(of("models/corner.obj").is_known());
    const auto scene = Scene::create(*config);
    ASSERT_TRUE(scene) << scene.error().message;
    const auto objects = scene->objects();
    ASSERT_EQ(objects.size(), 3U);
    EXPECT_EQ(objects[0].model_fingerprint, of("models/corner.obj"));
    EXPECT_EQ(objects[0].texture_fingerprint, of("models/paint.png"));
    EXPECT_FALSE(objects[1].model_fingerprint.is_known());
    EXPECT_FALSE(objects[1].texture_fingerprint.is_known());
    EXPECT_EQ(objects[2].texture_fingerprint, of("models/paint.png"));
    const bus::Scenery stage = to_message(config->scenery.at(0));
    EXPECT_EQ(stage.model_fingerprint, of("models/flat.obj"));
    EXPECT_FALSE(stage.texture_fingerprint.is_known());
}

// An added model and an edited object keep the versions of this start, which the state lacks.
TEST_F(WorldFile, FingerprintsTheFilesOfARestoredScene) {
    const auto config = read(kCorner + "mass_kg = 1\ntexture = \"models/paint.png\"\n");
    ASSERT_TRUE(config) << config.error().message;
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene) << scene.error().message;
    SavedWorld saved;
    scene->save(saved);
    bus::SceneObject added = scene->objects().front();
    added.object = 1000;
    added.model_fingerprint = added.texture_fingerprint = {7, 7};
    saved.added = {added};
    bus::SceneObject edited = scene->objects().front();
    edited.model_fingerprint = edited.texture_fingerprint = {};
    saved.edited = {edited};
    const auto restored = Scene::restore(*config, saved);
    ASSERT_TRUE(restored) << restored.error().message;
    const auto objects = restored->objects();
    ASSERT_EQ(objects.size(), 2U);
    for (const bus::SceneObject& object : objects) {
        EXPECT_EQ(object.model_fingerprint, fingerprint_of(folder_ / "models/corner.obj", 10'000));
        EXPECT_EQ(object.texture_fingerprint, fingerprint_of(folder_ / "models/paint.png", 10'000));
    }
}

TEST_F(WorldFile, ReadsModelsMaterialsAndTextures) {
    const auto config = read(
        "[[material]]\nname = \"clay\"\ndensity_kg_per_m3 = 1800\nfriction = 0.8\n"
        "restitution = 0.05\nrolling_friction_m = 0.01\ncolour = [0.5, 0.3, 0.2]\n"
        "texture = \"models/paint.png\"\n" +
        kCorner + "scale = 2\nmaterial = \"clay\"\nfriction = 0.3\n" +
        "[[object]]\nname = \"two\"\nshape = \"compound\"\nmodel = \"models/two.obj\"\n"
        "mass_kg = 3\n"
        "[[object]]\nname = \"steel-ball\"\nshape = \"sphere\"\ndiameter_m = 0.1\n"
        "material = \"steel\"\n");
    ASSERT_TRUE(config) << config.error().message;
    ASSERT_EQ(config->objects.size(), 3U);
    const WorldObject& corner = config->objects[0];
    EXPECT_EQ(corner.rigid.shape, physics::ObjectShape::kConvex);
    EXPECT_EQ(corner.look.model, "models/corner.obj");
    EXPECT_EQ(corner.look.model_scale, 2.0);
    EXPECT_EQ(corner.look.texture, "models/paint.png");
    EXPECT_LT((corner.rigid.size_m - Eigen::Vector3d::Constant(0.6)).norm(), 1e-6);
    EXPECT_NEAR(corner.rigid.mass_kg, 1800 * 0.6 * 0.6 * 0.6 / 6.0, 1e-3);
    EXPECT_EQ(corner.rigid.friction, 0.3) << "the object's own friction must win";
    EXPECT_EQ(corner.rigid.restitution, 0.05) << "restitution must come from the material";
    EXPECT_EQ(corner.rigid.rolling_friction_m, 0.01);
    EXPECT_EQ(corner.look.colour, Eigen::Vector3d(0.5, 0.3, 0.2));
    EXPECT_EQ(config->objects[1].rigid.shape, physics::ObjectShape::kCompound);
    EXPECT_EQ(config->objects[1].rigid.parts->size(), 2U);
    EXPECT_NEAR(config->objects[2].rigid.mass_kg, 7800 * EIGEN_PI / 6.0 * 1e-3, 1e-6);
    EXPECT_TRUE(Scene::create(*config));
}

TEST_F(WorldFile, ReadsJointsPuppetsBoundsAndScenery) {
    const auto config = read(
        kBall +
        "[[object]]\nname = \"post\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 1]\nmass_kg = 0\n"
        "position_m = [0, 1, 0.5]\n"
        "[[joint]]\nkind = \"hinge\"\na = \"ball\"\nb = \"post\"\nanchor_m = [0, 1, 0]\n"
        "axis = [0, 0, 1]\nlimits_deg = [-90, 45]\ndamping_nms = 0.1\ncollide = true\n"
        "[[joint]]\nkind = \"spring\"\na = \"jack.head\"\nanchor_m = [0, 0, 1.5]\n"
        "anchor_b_m = [0, 0, 2]\nstiffness_npm = 50\n"
        "[[puppet]]\nname = \"jack\"\nposition_m = [0, 0, 1]\nheight_m = 0.5\nstring_m = 0.3\n"
        "[bounds]\nmin_m = [-2, -2, -0.5]\nmax_m = [2, 2, 3]\nleave = \"bounce\"\n"
        "[[scenery]]\nname = \"hill\"\nmodel = \"models/corner.obj\"\nscale = 4\nsolid = true\n"
        "position_m = [1, 0, 0]\n");
    ASSERT_TRUE(config) << config.error().message;
    ASSERT_EQ(config->objects.size(), 15U);
    EXPECT_EQ(config->objects[2].name, "jack.pelvis");
    for (std::size_t i = 0; i < config->objects.size(); ++i)
        EXPECT_EQ(config->objects[i].rigid.id, i + 1) << "ids must have a stable order";
    ASSERT_EQ(config->joints.size(), 12U + 3U + 2U)
        << "joints of the puppet, of its strings, of the file";
    const physics::Joint& hinge = config->joints[15];
    EXPECT_EQ(hinge.kind, physics::JointKind::kHinge);
    EXPECT_EQ(hinge.a, 1U);
    EXPECT_EQ(hinge.b, 2U);
    EXPECT_TRUE(hinge.collides);
    EXPECT_NEAR((*hinge.limits)[0], -EIGEN_PI / 2, 1e-9);
    EXPECT_EQ(config->joints[16].rest_length_m, 0.5);
    ASSERT_TRUE(config->world.box);
    EXPECT_EQ(config->world.box->max, Eigen::Vector3d(2, 2, 3));
    EXPECT_EQ(config->world.leaving, physics::LeavePolicy::kBounce);
    ASSERT_EQ(config->scenery.size(), 1U);
    EXPECT_EQ(config->scenery[0].mesh.triangles.size(), 4U);
    auto scene = Scene::create(*config);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->world().num_joints(), 17U);
}

TEST_F(WorldFile, ErrorsNameFileLineKeyAndWhatIsAllowed) {
    const auto model = [](const std::string& shape, const std::string& file) {
        return "[[object]]\nname = \"a\"\nshape = \"" + shape + "\"\nmodel = \"" + file +
               "\"\nmass_kg = 1\n";
    };
    const auto joint = [](const std::string& rest) {
        return kBall + "[[joint]]\nkind = \"hinge\"\na = \"ball\"\nanchor_m = [0, 0, 0]\n" + rest;
    };
    const struct {
        std::string text;
        std::vector<std::string> named;
    } cases[] = {
        {model("convex", "models/none.obj"), {"world.toml:4", "model", "none.obj", "no such file"}},
        {model("convex", "models/Cornre.obj"), {"no such file (did you mean", "corner.obj?)"}},
        {"[world]\nmodels = \".\"\n" + model("convex", "models/none.obj"),
         {folder_.string() + "/models/none.obj: there is no such file"}},
        {model("convex", "models/chair.dae"), {"must be a .obj", "; export it as .glb"}},
        {"[light]\nsun = 1\n", {"world.toml:1: light: unknown key; known here: bounds"}},
        {"[[soft]]\nname = \"s\"\nshape = \"ball\"\ndiameter_m = 0.3\nmass_kg = 1\nyaw_deg = 20\n",
         {"soft[0].yaw_deg: unknown key; did you mean", "roll_pitch_yaw_deg?"}},
        {model("convex", "models/damaged.obj"), {"world.toml:4", "model", "damaged.obj"}},
        {model("convex", "models/cut.glb"), {"world.toml:4", "model", "cut.glb"}},
        {model("convex", "models/far.obj"), {"world.toml:4", "far.obj"}},
        {model("convex", "models/flat.obj"), {"world.toml:4", "model", "no volume"}},
        {model("convex", "../corner.obj"), {"world.toml:4", "model", "folder"}},
        {model("convex", "/etc/passwd"), {"world.toml:4", "model", "folder"}},
        {model("convex", "models/paint.png"), {"world.toml:4", "model", ".obj"}},
        {model("compound", "models/two.obj") + "scale = 500\n",
         {"world.toml:6", "scale", "the model is 650 x 150 x 150 m"}},
        {model("compound", "models/two.obj") + "scale = 0.001\n",
         {"with scale = 0.001, the model is only 0.0013 x", "what scale makes it metres?"}},
        {"[[object]]\nname = \"a\"\nshape = \"convex\"\nmass_kg = 1\n", {"model", "missing"}},
        {kCorner,
         {"world.toml:1", "mass_kg", "set it (0: fixed)", "density_kg_per_m3", "material"}},
        {kCorner + "fixed = true\n",
         {"world.toml:5: object[0].fixed: unknown key; mass_kg = 0 makes it fixed"}},
        {kCorner + "mass = 2\n",
         {"world.toml:5: object[0].mass: unknown key; did you mean mass_kg, which is missing?"}},
        {kBall + "[[joint]]\nkind = \"fixed\"\na = \"ball\"\nanchor_m = [0, 0, 0]\n",
         {"joint[0].kind: must be one of hinge, ball, slider, spring; a hinge with limits_deg = "
          "[0, 0] "
          "holds rigidly"}},
        {"[[soft]]\nname = \"s\"\nshape = \"cloth\"\nsize_m = [4, 3]\nmass_kg = 1\n",
         {"soft[0].spacing_m: must be at least 0.10 m, for at most 1500 nodes; the default is 0.05 "
          "m"}},
        {"[[soft]]\nname = \"s\"\nshape = \"cloth\"\nsize_m = [4, 3]\nmass_kg = 1\n"
         "spacing_m = 0.0625\n",
         {"must be at least 0.10 m, for at most 1500 nodes, got 0.0625"}},
        {kCorner + "mass_kg = 1\ndensity_kg_per_m3 = 100\n", {"world.toml:6", "density_kg_per_m3"}},
        {kCorner + "density_kg_per_m3 = 7.8\n",
         {"world.toml:5",
          "density_kg_per_m3: must be 14 to 30000 (water has 1000): multiply g/cm^3 by 1000",
          "mass_kg for what is filled with air"}},
        {"[[material]]\nname = \"m\"\ndensity_kg_per_m3 = 2.5\n",
         {"world.toml:3", "multiply g/cm^3 by 1000"}},
        {"[[object]]\nname = \"s\"\nshape = \"sphere\"\nsize_m = [1, 1, 1]\nmass_kg = 1\n",
         {"world.toml:4", "size_m: unknown key; write diameter_m"}},
        {"[[object]]\nname = \"s\"\nshape = \"box\"\nsize_m = [5, 5, 5]\nmaterial = \"wood\"\n",
         {"world.toml:5: object[0].material: must give a mass of 125 to 10000 kg",
          "its volume of 125 m^3 "
          "gives "
          "75000 kg: write mass_kg, or see its size: it is 5 x 5 x 5 m"}},
        {"[[object]]\nname = \"s\"\nshape = \"box\"\nsize_m = [60, 50, 16]\nmass_kg = 1\n",
         {"world.toml:4: object[0].size_m: must be 0.01 m to 20 m; are these centimetres or "
          "millimetres? Divide by 100 or 1000, got [60, 50, 16]"}},
        {"[[object]]\nname = \"s\"\nshape = \"box\"\nsize_m = [60, 50, 1.6]\nmass_kg = 1\n",
         {"20 m; are these centimetres? Divide by 100, got"}},
        {"[[object]]\nname = \"s\"\nshape = \"cylinder\"\ndiameter_m = 12\nheight_m = 40\n"
         "mass_kg = 1\n",
         {"height_m: must be 0.01 m to 20 m; are these centimetres or millimetres? Divide by 100 "
          "or 1000, got 40"}},
        {"[[object]]\nname = \"s\"\nshape = \"box\"\nsize_m = [60, 0.5, 0.16]\nmass_kg = 1\n",
         {"size_m: must be 0.01 m to 20 m, got"}},
        {"[[soft]]\nname = \"s\"\nshape = \"box\"\nsize_m = [60, 50, 16]\nmass_kg = 1\n",
         {"soft[0].size_m: must be 0.01 m to 20 m",
          "; are these centimetres or millimetres? Divide by 100 or 1000, got"}},
        {"[[soft]]\nname = \"s\"\nshape = \"cloth\"\nsize_m = [12000, 18000]\nmass_kg = 1\n",
         {"; are these millimetres? Divide by 1000, got"}},
        {kCorner + "material = \"cheese\"\n", {"world.toml:5", "material", "rubber", "wood"}},
        {kBall + "texture = \"models/none.png\"\n", {"world.toml:6", "texture", "none.png"}},
        {kBall + "texture = \"models/corner.obj\"\n", {"world.toml:6", "texture", ".png"}},
        {"[[material]]\nname = \"m\"\nfiction = 1\n", {"world.toml:3", "fiction", "friction"}},
        {joint("axis = [0, 0, 1]\nb = \"bell\"\n"),
         {"world.toml:11", "b", "object", "did you mean ball?"}},
        {joint("axis = [0, 0, 1]\nlimits_deg = [10, 50]\n"),
         {"world.toml:11", "limits_deg", "180"}},
        {joint("axis = [0, 0, 0]\n"), {"world.toml:10", "axis"}},
        {joint("axis = [0, 0, 1]\nswing_deg = 5\n"), {"world.toml:11", "swing_deg", "known here"}},
        {joint("axis = [0, 0, 1]\nmotor_deg_per_s = 5\n"), {"motor_max_nm", "missing"}},
        {joint(""), {"world.toml:6", "axis", "missing"}},
        {"[[joint]]\nkind = \"glue\"\n", {"world.toml:2", "kind", "slider"}},
        {"[[puppet]]\nname = \"p\"\nheight_m = 9\n", {"world.toml:3", "height_m", "2"}},
        {"[[puppet]]\nname = \"p\"\nposition_m = [0, 0, 1]\n[[puppet]]\nname = \"p\"\n",
         {"world.toml:5", "name", "unique"}},
        {"[bounds]\nmin_m = [0, 0, 0]\nmax_m = [0, 1, 1]\n", {"world.toml:3", "max_m"}},
        {"[bounds]\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]\nleave = \"explode\"\n",
         {"world.toml:4", "leave", "bounce"}},
        {kBall + "[bounds]\nmin_m = [1, 1, 1]\nmax_m = [2, 2, 2]\n",
         {"world.toml:1: object 'ball'", "inside", "[1, 1, 1] to [2, 2, 2] m; it is at ["}},
        {"[[soft]]\nname = \"far\"\nshape = \"ball\"\ndiameter_m = 0.3\nmass_kg = 1.0\n"
         "position_m = [50, 0, 1]\n",
         {"world.toml:6: soft object 'far'", "inside"}},
        {"[[scenery]]\nname = \"s\"\nmodel = \"models/none.obj\"\n", {"world.toml:3", "none.obj"}},
    };
    for (const auto& c : cases) {
        const std::string message = error_of(c.text);
        for (const std::string& part : c.named) EXPECT_THAT(message, HasSubstr(part)) << c.text;
    }
}

}  // namespace
}  // namespace atrium::world_server
