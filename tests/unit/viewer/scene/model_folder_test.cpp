#include "viewer/scene/model_folder.hpp"

#include "tests/support/comes_true.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <map>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;

TEST(ModelFolder, ListsModelsOfAllFoldersAndMeasuresThem) {
    const fs::path root = fs::temp_directory_path() / ("atrium-models-" + std::to_string(getpid()));
    fs::create_directories(root / "models/deep");
    fs::create_directories(root / ".hidden");
    const auto put = [&](const char* name, const char* text) {
        std::ofstream(root / name) << text;
    };
    put("models/tetra.obj",
        "mtllib tetra.mtl\nv 0 0 0\nv 2 0 0\nv 0 0.5 0\nv 0 0 1\nusemtl red\nf 1 3 2\nf 1 2 4\nf 1 "
        "4 3\nf 2 3 4\n");
    put("models/tetra.mtl", "newmtl red\nKd 0.8 0.1 0.2\n");
    put("models/deep/broken.obj", "v 0 0 0\nf 1 2 900\n");
    put("models/paint.png", "a picture");
    put("models/a name.obj", "");
    put("scene.FBX", "");
    put(".hidden/secret.obj", "");
    ModelFolder folder(root);
    EXPECT_EQ(folder.list(), nullptr);
    folder.show(true);
    ASSERT_TRUE(test_support::comes_true([&] {
        folder.update();
        return folder.list() != nullptr;
    }));
    std::map<std::string, std::string> problems;
    for (const ModelEntry& entry : *folder.list()) problems[entry.file] = entry.problem;
    EXPECT_THAT(
        problems,
        testing::ElementsAre(testing::Pair("models/a name.obj", testing::HasSubstr("rename it")),
                             testing::Pair("models/deep/broken.obj", ""),
                             testing::Pair("models/tetra.obj", ""),
                             testing::Pair("scene.FBX", "export it as .glb")));
    for (const char* file : {"models/tetra.obj", "models/deep/broken.obj"}) folder.measure(file);
    ASSERT_TRUE(test_support::comes_true([&] {
        folder.update();
        return folder.size_of("models/tetra.obj") && folder.size_of("models/deep/broken.obj");
    }));
    EXPECT_TRUE(folder.size_of("models/tetra.obj")->size_m.isApprox(Eigen::Vector3d(2, 0.5, 1)));
    EXPECT_EQ(folder.size_of("models/tetra.obj")->num_triangles, 4U);
    ASSERT_EQ(folder.size_of("models/tetra.obj")->colours.size(), 1U);
    EXPECT_TRUE(folder.size_of("models/tetra.obj")
                    ->colours.front()
                    .isApprox(Eigen::Vector3d(0.8, 0.1, 0.2), 1e-6));
    EXPECT_FALSE(folder.size_of("models/tetra.obj")->preview.greys.empty());
    EXPECT_TRUE(folder.size_of("models/deep/broken.obj")->preview.greys.empty());
    EXPECT_THAT(folder.size_of("models/deep/broken.obj")->error, testing::HasSubstr("broken.obj"));
    fs::remove(root / "models/deep/broken.obj");
    const auto update = [&](bool is_shown) {
        folder.show(is_shown);
        folder.update();
        return folder.list()->size();
    };
    EXPECT_EQ(update(true), 4U) << "still the same list";
    update(false);
    EXPECT_TRUE(test_support::comes_true([&] { return update(true) == 3U; })) << "read anew";
    fs::remove_all(root);
}

// A cube shows three faces of three greys, the brightest on top.
TEST(ModelPreview, ShowsTheFacesTowardsTheEye) {
    model::ModelPart cube;
    for (int i = 0; i < 8; ++i) cube.mesh.vertices.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    cube.mesh.triangles = {{0, 1, 3},
                           {0, 3, 2},
                           {4, 5, 7},
                           {4, 7, 6},
                           {0, 1, 5},
                           {0, 5, 4},
                           {2, 3, 7},
                           {2, 7, 6},
                           {0, 2, 6},
                           {0, 6, 4},
                           {1, 3, 7},
                           {1, 7, 5}};
    const ModelPreview preview = draw_preview({cube});
    ASSERT_EQ(preview.greys.size(),
              std::size_t{ModelPreview::kWidth} * std::size_t{ModelPreview::kHeight});
    std::map<int, int> num_of;
    for (const std::uint8_t grey : preview.greys) ++num_of[grey];
    EXPECT_EQ(num_of.size(), 4U) << "three faces and the background";
    for (const auto& [grey, num] : num_of) EXPECT_GT(num, 300) << grey;
    const auto at = [&](int x, int y) {
        return preview.greys[static_cast<std::size_t>(y * ModelPreview::kWidth + x)];
    };
    EXPECT_EQ(at(ModelPreview::kWidth / 2, 15), num_of.rbegin()->first) << "the upper face";
    EXPECT_EQ(at(2, 2), ModelPreview::kBackground);
    EXPECT_TRUE(draw_preview({}).greys.empty());
}

}  // namespace
}  // namespace atrium::viewer
