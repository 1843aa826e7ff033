#include "simulation/model.hpp"

#include "core/geometry/aabb.hpp"
#include "simulation/model_rig.hpp"
#include "simulation/room_renderer.hpp"
#include "simulation/simulated_loop.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace atrium::simulation {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path kWalker =
    fs::path(atrium::test::source_dir()) / "../shared/data/models/cesium_man.gltf";

RoomOptions options_of(const fs::path& model) {
    RoomOptions options;
    options.model = model;
    options.loop_s = 2.0;
    options.noise_lsb = 0.0;
    options.num_empty_frames = 1;
    return options;
}

geometry::Aabb box_of(const PosedSkin& skin) {
    geometry::Aabb box;
    for (const Eigen::Vector3f& p : skin.positions) box.add(p.cast<double>());
    return box;
}

class ModelFile : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  ("atrium_model_" +
                   std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path file(const std::string& name, const std::string& text) {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }

    // A column of 0.2 x 0.2 m in one colour, with that height along the file's +Y.
    fs::path column(double height, const std::string& colour) {
        file("column.mtl", "newmtl paint\nKd " + colour + "\n");
        std::string text = "mtllib column.mtl\nusemtl paint\n";
        for (const double y : {0.0, height}) {
            for (const auto& [x, z] : {std::pair(-0.1, -0.1), {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}})
                text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
                        std::to_string(z) + "\n";
        }
        text += "f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
        return file("column.obj", text);
    }

    fs::path folder_;
};

// Two bones along +Y. The lower one stands still, and the upper one turns about +Z by 90 degrees in
// a second.
ModelRig two_bones() {
    ModelRig rig;
    ModelNode upper;
    upper.parent = 0;
    upper.parent_from_node.translation() = Eigen::Vector3f(0, 1, 0);
    upper.rotations = {{0.0, Eigen::Quaternionf::Identity()},
                       {1.0,
                        Eigen::Quaternionf(Eigen::AngleAxisf(std::numbers::pi_v<float> / 2,
                                                             Eigen::Vector3f::UnitZ()))}};
    rig.nodes = {ModelNode{}, upper};
    ModelBone lower_bone;
    ModelBone upper_bone{.node = 1, .node_from_mesh = Eigen::Affine3f::Identity()};
    upper_bone.node_from_mesh.translation() = Eigen::Vector3f(0, -1, 0);
    rig.bones = {lower_bone, upper_bone};
    rig.positions = {{0, 0.5f, 0}, {0, 2, 0}, {1, 1, 0}};
    rig.normals = {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    rig.weights = {{0, 1.0f}, {1, 1.0f}, {0, 0.5f}, {1, 0.5f}};
    rig.first_weight = {0, 1, 2, 4};
    rig.duration_s = 1.0;
    return rig;
}

TEST(ModelRig, BonesCarryTheirVertices) {
    std::vector<Eigen::Affine3f> scratch;
    PosedSkin skin;
    pose_rig(two_bones(), 1.0, scratch, skin);
    EXPECT_TRUE(skin.positions[0].isApprox(Eigen::Vector3f(0, 0.5f, 0)));
    EXPECT_TRUE(skin.positions[1].isApprox(Eigen::Vector3f(-1, 1, 0), 1e-5f));
    EXPECT_TRUE(skin.normals[1].isApprox(Eigen::Vector3f(0, 1, 0), 1e-5f));
    // half weights: between the positions of both bones
    EXPECT_TRUE(skin.positions[2].isApprox(Eigen::Vector3f(0.5f, 1.5f, 0), 1e-5f));
    pose_rig(two_bones(), 0.5, scratch, skin);
    const float half = std::sqrt(0.5f);
    EXPECT_TRUE(skin.positions[1].isApprox(Eigen::Vector3f(-half, 1 + half, 0), 1e-5f));
}

TEST_F(ModelFile, StandsUprightAtItsConfiguredPlace) {
    RoomOptions options = options_of(column(1.2, "1 0 0"));
    options.position_m = {0.5, -0.25, 0.1};
    const auto model = Model::load(options);
    ASSERT_TRUE(model) << model.error().message;
    PosedSkin skin;
    model->pose(0.7, skin);
    const geometry::Aabb box = box_of(skin);
    EXPECT_TRUE(box.min.isApprox(Eigen::Vector3d(0.4, -0.35, 0.1), 1e-4));
    EXPECT_TRUE(box.max.isApprox(Eigen::Vector3d(0.6, -0.15, 1.3), 1e-4));
    for (const Eigen::Vector3f& normal : skin.normals) EXPECT_NEAR(normal.norm(), 1.0, 1e-4);
}

TEST_F(ModelFile, HasTheConfiguredHeightOrThatOfAPerson) {
    const auto height_of = [](const RoomOptions& options) {
        PosedSkin skin;
        Model::load(options)->pose(0.0, skin);
        return box_of(skin).size().z();
    };
    RoomOptions options = options_of(column(180.0, "1 0 0"));  // a model in centimetres
    EXPECT_NEAR(height_of(options), 1.80, 1e-4);
    EXPECT_NEAR(height_of(options_of(column(20.0, "1 0 0"))), 0.508, 1e-4);  // inches
    EXPECT_NEAR(height_of(options_of(column(5.0, "1 0 0"))), 1.75, 1e-4);    // no unit fits
    options = options_of(column(180.0, "1 0 0"));
    options.model_height_m = 0.9;
    EXPECT_NEAR(height_of(options), 0.9, 1e-4);
}

TEST_F(ModelFile, HasTheColourOfItsMaterial) {
    const auto camera = ring(1).front();
    auto renderer = RoomRenderer::create({camera}, options_of(column(1.8, "0 1 0")));
    ASSERT_TRUE(renderer) << renderer.error().message;
    image::YuvImage picture;
    image::Mask mask;
    renderer->render(0.0, 0, Scene::kPerson, 0, picture, &mask);
    std::size_t num_covered = 0;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            ++num_covered;
            if (x % 2 != 0 || y % 2 != 0 || mask.at(x + 1, y + 1) == 0 || mask.at(x + 1, y) == 0 ||
                mask.at(x, y + 1) == 0)
                continue;
            EXPECT_LT(picture.u.at(x / 2, y / 2), 110);
            EXPECT_LT(picture.v.at(x / 2, y / 2), 110);
        }
    }
    EXPECT_GT(num_covered, 500u);
}

TEST_F(ModelFile, NamesFilesThatCannotBeRead) {
    const auto missing = Model::load(options_of("/nonexistent/model.gltf"));
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(missing.error().message, HasSubstr("/nonexistent/model.gltf"));
    for (const char* name : {"a.gltf", "a.fbx", "a.dae", "a.unknown"}) {
        const auto broken = Model::load(options_of(file(name, "{\"asset\": 3")));
        ASSERT_FALSE(broken) << name;
        EXPECT_EQ(broken.error().kind, ErrorKind::kInvalidData) << name;
        EXPECT_THAT(broken.error().message, HasSubstr(name));
    }
}

TEST_F(ModelFile, AnotherModelHasItsOwnCachedLoop) {
    const auto cameras = ring(2);
    RoomOptions options = options_of(column(1.2, "1 0 0"));
    const fs::path first = cache_file(cameras, options, "cache");
    EXPECT_EQ(cache_file(cameras, options, "cache"), first);
    options.model_turn_rad = 1.0;
    EXPECT_NE(cache_file(cameras, options, "cache"), first);
    options.model_turn_rad = 0.0;
    column(1.3, "1 0 0");
    EXPECT_NE(cache_file(cameras, options, "cache"), first);
    options.model.clear();
    EXPECT_NE(cache_file(cameras, options, "cache"), first);
}

class Walker : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(kWalker)) GTEST_SKIP() << atrium::test::skip::kNoSharedData << kWalker;
    }
};

TEST_F(Walker, WalksOnTheSpotInAClosedLoop) {
    const RoomOptions options = options_of(kWalker);
    const auto model = Model::load(options);
    ASSERT_TRUE(model) << model.error().message;
    PosedSkin first, skin, former;
    model->pose(0.0, first);
    former = first;
    double lowest = 1.0;
    double farthest = 0.0;
    for (int i = 1; i <= options.num_frames(); ++i) {
        model->pose(options.frame_time_s(i), skin);
        const geometry::Aabb box = box_of(skin);
        lowest = std::min(lowest, box.min.z());
        EXPECT_GT(box.min.z(), -0.03);
        EXPECT_NEAR(box.size().z(), 1.5, 0.3);
        double step = 0.0;
        for (std::size_t v = 0; v < skin.positions.size(); ++v) {
            step = std::max<double>(step, (skin.positions[v] - former.positions[v]).norm());
            farthest = std::max<double>(farthest, (skin.positions[v] - first.positions[v]).norm());
        }
        EXPECT_LT(step, 0.25) << "jumps at frame " << i;
        former = skin;
    }
    EXPECT_LT(lowest, 0.02);
    EXPECT_GT(farthest, 0.3);  // limbs do move
    // the loop ends with its first pose
    model->pose(options.frame_time_s(options.num_frames()), skin);
    for (std::size_t v = 0; v < skin.positions.size(); ++v)
        EXPECT_LT((skin.positions[v] - first.positions[v]).norm(), 1e-3f);
}

TEST_F(Walker, WearsItsTexture) {
    const auto model = Model::load(options_of(kWalker));
    ASSERT_TRUE(model);
    ASSERT_EQ(model->surface().textures.size(), 1u);
    const auto cameras = ring(1);
    auto renderer = RoomRenderer::create(cameras, options_of(kWalker));
    ASSERT_TRUE(renderer) << renderer.error().message;
    image::YuvImage picture;
    image::Mask mask;
    renderer->render(0.0, 0, Scene::kPerson, 0, picture, &mask);
    // white, green and blue stripes: luma and chroma vary widely
    int num_white = 0;
    int num_coloured = 0;
    for (int y = 0; y + 1 < mask.height; y += 2) {
        for (int x = 0; x + 1 < mask.width; x += 2) {
            if (mask.at(x, y) == 0) continue;
            const int u = picture.u.at(x / 2, y / 2) - 128;
            const int v = picture.v.at(x / 2, y / 2) - 128;
            if (std::hypot(u, v) < 12.0 && picture.y.at(x, y) > 150) ++num_white;
            if (std::hypot(u, v) > 20.0) ++num_coloured;
        }
    }
    EXPECT_GT(num_white, 100);
    EXPECT_GT(num_coloured, 30);
}

}  // namespace
}  // namespace atrium::simulation
