#include "viewer/scene/model_library.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <thread>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;

// A folder with a tetrahedron, and a file outside the folder.
class ModelLibraryTest : public testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(root_ / "models");
        for (const fs::path& file : {root_ / "models" / "tetra.obj", root_ / "outside.obj"}) {
            std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                   "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
        }
    }
    void TearDown() override { fs::remove_all(root_); }

    static bus::SceneObject object(const std::string& model, double scale) {
        bus::SceneObject object;
        object.object = 4;
        object.shape = bus::Shape::kConvex;
        object.model = model;
        object.model_scale = scale;
        object.size_m = {0.3, 0.4, 0.5};
        object.colour = {0.1, 0.2, 0.3};
        return object;
    }

    // The look of an object once its model is loaded.
    template <typename Described, typename... Rest>
    auto look_in_the_end(const Described& described, Rest... rest) {
        library_.look_of(described, rest...);
        while (!library_.take().contains(described.model)) std::this_thread::yield();
        return library_.look_of(described, rest...);
    }

    fs::path root_ = fs::temp_directory_path() / ("atrium-models-" + std::to_string(getpid()));
    ModelLibrary library_{root_ / "models"};
};

TEST_F(ModelLibraryTest, GivesAnObjectItsModelInTheObjectsColour) {
    const auto before = library_.look_of(object("tetra.obj", 0.5), renderer::ShapeKind::kBox);
    EXPECT_FALSE(before.model) << "drawing must not wait for a file";
    const auto look = look_in_the_end(object("tetra.obj", 0.5), renderer::ShapeKind::kBox);
    ASSERT_TRUE(look.model);
    EXPECT_EQ(look.model->indices.size(), 12U);
    EXPECT_TRUE(look.colour.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
    float largest = 0.0F;
    for (const auto& corner : look.model->corners) {
        largest = std::max(largest, corner.position_object.maxCoeff());
        EXPECT_NEAR(corner.normal_object.norm(), 1.0F, 1e-5F);
    }
    EXPECT_NEAR(largest, 0.5F, 1e-6F) << "as scaled";
    // the edges are sharp: the bottom's corners point down, all three
    int num_down = 0;
    for (const auto& corner : look.model->corners)
        num_down += corner.normal_object.z() < -0.999F ? 1 : 0;
    EXPECT_EQ(num_down, 3);
    const auto again = library_.look_of(object("tetra.obj", 0.5), renderer::ShapeKind::kBox);
    EXPECT_EQ(again.model, look.model) << "the model must be read only once";
}

TEST_F(ModelLibraryTest, TakesTextureCoordinatesFromTheFileOrFromAbove) {
    bus::SceneObject thing = object("tetra.obj", 1.0);
    thing.texture = "wood.png";
    const auto plain = look_in_the_end(thing, renderer::ShapeKind::kBox);
    EXPECT_EQ(plain.texture, "wood.png");
    ASSERT_TRUE(plain.model);
    for (const auto& corner : plain.model->corners) {
        EXPECT_TRUE(corner.texture_place.isApprox(
            renderer::projected_place(corner.position_object, corner.normal_object)));
    }
    std::ofstream(root_ / "models/painted.obj")
        << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.25 0.125\nvt 0.5 0.125\nvt 0.25 1\nf 1/1 2/2 3/3\n";
    const auto painted = look_in_the_end(object("painted.obj", 1.0), renderer::ShapeKind::kBox);
    ASSERT_TRUE(painted.model);
    ASSERT_EQ(painted.model->corners.size(), 3U);
    for (const auto& corner : painted.model->corners) {
        const Eigen::Vector3f p = corner.position_object;
        // the file counts from the bottom
        const Eigen::Vector2f place(p.x() > 0.5F ? 0.5F : 0.25F, p.y() > 0.5F ? 0.0F : 0.875F);
        EXPECT_LT((corner.texture_place - place).norm(), 1e-5F) << p.transpose();
    }
}

TEST_F(ModelLibraryTest, TakesColoursPerVertexFromTheFile) {
    EXPECT_TRUE(look_in_the_end(object("tetra.obj", 1.0), renderer::ShapeKind::kBox)
                    .model->colours.empty());
    std::ofstream(root_ / "models/scan.ply")
        << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
           "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
           "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 128\n3 0 1 2\n";
    const auto scan = look_in_the_end(object("scan.ply", 1.0), renderer::ShapeKind::kBox);
    ASSERT_TRUE(scan.model);
    ASSERT_EQ(scan.model->corners.size(), 3U);
    ASSERT_EQ(scan.model->colours.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3f p = scan.model->corners[i].position_object;
        const Eigen::Vector3f colour = p.x() > 0.5F   ? Eigen::Vector3f(0, 1, 0)
                                       : p.y() > 0.5F ? Eigen::Vector3f(0, 0, 0.2159F)
                                                      : Eigen::Vector3f(1, 0, 0);
        EXPECT_LT((scan.model->colours[i] - colour).norm(), 1e-3F) << p.transpose();
    }
}

TEST_F(ModelLibraryTest, ReplacesAMissingModelByABox) {
    // the library handles the last request after all others
    for (const char* missing : {"../outside.obj", "tetra.txt", "none.obj"})
        library_.look_of(object(missing, 1.0), renderer::ShapeKind::kBox);
    look_in_the_end(object("none.obj", 2.0), renderer::ShapeKind::kBox);
    for (const char* missing : {"none.obj", "../outside.obj", "tetra.txt"}) {
        const auto look = library_.look_of(object(missing, 1.0), renderer::ShapeKind::kBox);
        EXPECT_FALSE(look.model) << missing;
        EXPECT_EQ(look.shape, renderer::ShapeKind::kBox);
        EXPECT_TRUE(look.size_m.isApprox(Eigen::Vector3d(0.3, 0.4, 0.5)));
    }
}

TEST_F(ModelLibraryTest, GivesSceneryThePartsOfItsModel) {
    bus::Scenery scenery;
    scenery.name = "room";
    scenery.model = "tetra.obj";
    scenery.world_from_model.translation = {1, 2, 3};
    const auto looks = look_in_the_end(scenery);
    ASSERT_EQ(looks.size(), 1U);
    ASSERT_TRUE(looks[0].model);
    EXPECT_TRUE(looks[0].world_from_object.translation.isApprox(Eigen::Vector3d(1, 2, 3)));
    scenery.model = "none.obj";
    const auto box = look_in_the_end(scenery);
    ASSERT_EQ(box.size(), 1U);
    EXPECT_FALSE(box[0].model);
}

TEST_F(ModelLibraryTest, ColoursSceneryForWhichTheFileStatesNoColour) {
    std::ofstream(root_ / "models" / "red.mtl") << "newmtl red\nKd 0.8 0.1 0.1\n";
    std::ofstream(root_ / "models" / "red.obj")
        << "mtllib red.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
           "o red\nusemtl red\nf 1 2 4\nf 1 4 3\n";
    std::ofstream(root_ / "models" / "bare.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\n";
    bus::Scenery scenery;
    scenery.name = "quay";
    scenery.colour = {0.1, 0.2, 0.3};
    for (const auto& [file, colour] : {std::pair("red.obj", Eigen::Vector3d(0.8, 0.1, 0.1)),
                                       std::pair("bare.obj", Eigen::Vector3d(0.1, 0.2, 0.3))}) {
        scenery.model = file;
        const auto looks = look_in_the_end(scenery);
        ASSERT_EQ(looks.size(), 1U);
        ASSERT_TRUE(looks[0].model);
        EXPECT_TRUE(looks[0].colour.isApprox(colour, 1e-6)) << looks[0].colour.transpose();
    }
}

TEST_F(ModelLibraryTest, ReadsAChangedFileAgainWhenTheServerHasIt) {
    const bus::SceneObject thing = object("tetra.obj", 1.0);
    const fs::path file = root_ / "models" / "tetra.obj";
    const auto first = look_in_the_end(thing, renderer::ShapeKind::kBox);
    auto now = FileVersions::Clock::now();
    // looks for changed files, and returns what was read anew
    const auto look_again = [&] {
        now += FileVersions::kPeriod;
        std::set<std::string> changed = library_.take(now);
        while (!library_.is_idle()) changed.merge(library_.take(now));
        return changed;
    };
    std::ofstream(file, std::ios::app) << "v 0 0 2\nf 1 3 5\n";
    EXPECT_TRUE(look_again().empty()) << "nobody says that it has changed";
    library_.expect("tetra.obj", fingerprint_of(file, 10'000));
    EXPECT_FALSE(library_.is_different("tetra.obj", 1.0)) << "it was not looked at yet";
    EXPECT_TRUE(look_again().contains("tetra.obj"));
    const auto second = library_.look_of(thing, renderer::ShapeKind::kBox);
    ASSERT_TRUE(second.model);
    EXPECT_EQ(second.model->indices.size(), first.model->indices.size() + 3);
    EXPECT_FALSE(library_.is_different("tetra.obj", 1.0));

    library_.expect("tetra.obj", {1, 1});
    EXPECT_TRUE(look_again().empty()) << "the file has not changed";
    EXPECT_TRUE(library_.is_different("tetra.obj", 1.0));
    EXPECT_EQ(library_.look_of(thing, renderer::ShapeKind::kBox).model, second.model);
    // half of a file that is being copied
    std::ofstream(file, std::ios::trunc) << "v 0 0 0\n";
    EXPECT_TRUE(look_again().empty());
    EXPECT_EQ(library_.look_of(thing, renderer::ShapeKind::kBox).model, second.model);
    EXPECT_TRUE(library_.is_different("tetra.obj", 1.0));
    EXPECT_FALSE(library_.is_missing("tetra.obj", 1.0));
}

// The colours of an OBJ file are in another one, which may have changed alone.
TEST_F(ModelLibraryTest, ComparesTheFilesThatAModelNames) {
    const fs::path folder = root_ / "models";
    const auto write = [&](const std::string& colour) {
        std::ofstream(folder / "red.mtl") << "newmtl c\nKd " << colour << "\n";
    };
    std::ofstream(folder / "coloured.obj") << "mtllib red.mtl\nusemtl c\nv 0 0 0\nv 1 0 0\n"
                                              "v 0 1 0\nf 1 2 3\n";
    FilesRead absent;
    FilesRead red;
    FilesRead blue;
    ASSERT_TRUE(model::load_model(folder / "coloured.obj", 1.0, {}, &absent));
    write("1 0 0");
    EXPECT_TRUE(absent.have_changed()) << "the file of colours has come";
    ASSERT_TRUE(model::load_model(folder / "coloured.obj", 1.0, {}, &red));
    write("0 0 1");
    EXPECT_TRUE(red.have_changed());
    ASSERT_TRUE(model::load_model(folder / "coloured.obj", 1.0, {}, &blue));
    EXPECT_EQ(absent.fingerprint, fingerprint_of(folder / "coloured.obj", 10'000));
    EXPECT_EQ(blue.fingerprint,
              fingerprint_of({fingerprint_of(folder / "red.mtl", 10'000),
                              fingerprint_of(folder / "coloured.obj", 10'000)}));
    EXPECT_NE(red.fingerprint, blue.fingerprint);
    EXPECT_NE(red.fingerprint, absent.fingerprint);
    EXPECT_FALSE(blue.have_changed());
}

TEST_F(ModelLibraryTest, ComparesTheVerticesBesideAGltfFile) {
    const fs::path file = root_ / "models" / "three.gltf";
    const fs::path beside = root_ / "models" / "three.bin";
    std::ofstream(file)
        << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
        << R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
        << R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
        << R"("bufferViews":[{"buffer":0,"byteLength":36}],)"
        << R"("buffers":[{"uri":"three.bin","byteLength":36}]})";
    const auto read_with = [&](float height_m) {
        const float vertices[9] = {0, 0, 0, 1, 0, 0, 0, height_m, 0};
        std::ofstream(beside, std::ios::binary)
            .write(reinterpret_cast<const char*>(vertices), sizeof(vertices));
        FilesRead files;
        const auto parts = model::load_model(file, 1.0, {}, &files);
        EXPECT_TRUE(parts) << parts.error().message;
        return files.fingerprint;
    };
    const Fingerprint low = read_with(1.0F);
    EXPECT_EQ(low.num_bytes, fs::file_size(file) + 36);
    EXPECT_EQ(read_with(1.0F), low);
    EXPECT_NE(read_with(2.0F), low);
}

}  // namespace
}  // namespace atrium::viewer
