#include "tests/support/temporary_folder.hpp"
#include "tests/unit/export/ball_person.hpp"
#include "tools/export/export.hpp"
#include "tools/export/frame_source.hpp"

#include <assimp/Importer.hpp>
#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

namespace atrium::exporting {
namespace {

using Names = std::vector<std::string>;

class RecordingExport : public ::testing::Test {
protected:
    ExportConfig config(const testing::BallRecording& content = {}) {
        ExportConfig result;
        result.file = folder_ / "balls.mcap";
        testing::write_balls(result.file, "alice", content);
        result.output = folder_ / "out";
        std::filesystem::create_directory(result.output);
        result.threads = 3;
        return result;
    }
    Names written() const { return testing::names_in(folder_ / "out"); }
    static std::string error_of(const ExportConfig& config) {
        const auto good = check(config);
        if (!good) return good.error().message;
        const auto done = run_export(config, {});
        return done ? "" : done.error().message;
    }

    test::TemporaryFolder folder_;
};

TEST_F(RecordingExport, WritesTheFramesOfARange) {
    ExportConfig config = this->config();
    config.format = "obj";
    // the first sample is at 0 s, frames at 1.05, 1.10, ... s
    config.from_s = 1.09;
    config.to_s = 1.21;
    EXPECT_EQ(error_of(config), "");
    EXPECT_EQ(written().size(), 9u);
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile((folder_ / "out" / "alice_000002.obj").string(), 0);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    for (unsigned i = 0; i < scene->mMeshes[0]->mNumVertices; ++i) {
        const aiVector3D& p = scene->mMeshes[0]->mVertices[i];
        // the third frame of the recording, 2 cm higher than the first
        EXPECT_LT(testing::off_surface_m({p.x, p.y, p.z - 0.02}), 0.002);
    }
}

TEST_F(RecordingExport, PlacesPeopleInTheWorld) {
    ExportConfig config = this->config();
    config.output = folder_ / "out" / "one.obj";
    config.frame = "world";
    EXPECT_EQ(error_of(config), "");
    EXPECT_EQ(written(), (Names{"one.jpg", "one.mtl", "one.obj"}));
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(config.output.string(), 0);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    for (unsigned i = 0; i < scene->mMeshes[0]->mNumVertices; ++i) {
        const aiVector3D& p = scene->mMeshes[0]->mVertices[i];
        // turned by 90 degrees, 5 m along x
        EXPECT_LT(testing::off_surface_m({p.y, 5.0 - p.x, p.z}), 0.002);
    }
}

TEST_F(RecordingExport, IsTheSameWithAnyNumberOfThreads) {
    ExportConfig config = this->config();
    config.output = folder_ / "out" / "a.glb";
    EXPECT_EQ(error_of(config), "");
    const auto several = testing::bytes_of(config.output);
    config.threads = 1;
    EXPECT_EQ(error_of(config), "");
    EXPECT_EQ(testing::bytes_of(config.output), several);
}

TEST_F(RecordingExport, LeavesOutIncompleteFramesAndEveryOther) {
    testing::BallRecording content;
    content.lacks_textures_of_frame_3 = true;
    ExportConfig config = this->config(content);
    config.format = "ply";
    EXPECT_EQ(error_of(config), "");
    EXPECT_EQ(written().size(), 5u);
    config.every = 2;
    config.output = folder_ / "second";
    EXPECT_EQ(error_of(config), "");
    EXPECT_EQ(testing::names_in(folder_ / "second").size(), 3u);
}

TEST_F(RecordingExport, CountsDamagedChunks) {
    ExportConfig config = this->config();
    config.format = "ply";
    {
        const auto world = recording::WorldFile::open(config.file);
        ASSERT_TRUE(world);
        const auto& chunks = (*world)->file().contents().chunks;
        const auto people = std::ranges::max_element(chunks, {}, &mcap::ChunkIndex::length);
        std::fstream file(config.file, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(people->offset + people->length / 2));
        file.write("\x55\xAA\x55\xAA", 4);
    }
    EXPECT_NE(error_of(config).find("(refused 0, damaged 1, incomplete 0)"), std::string::npos)
        << error_of(config);
}

TEST_F(RecordingExport, KeepsFramesWithoutAnybody) {
    testing::BallRecording content;
    content.is_empty_at_frame_2 = true;
    ExportConfig config = this->config(content);
    config.format = "points";
    config.points = 50;
    EXPECT_EQ(error_of(config), "");
    EXPECT_EQ(written().size(), 6u);
    EXPECT_LT(std::filesystem::file_size(folder_ / "out" / "alice_000002.ply"), 800u);
    EXPECT_GT(std::filesystem::file_size(folder_ / "out" / "alice_000003.ply"), 1500u);
}

TEST_F(RecordingExport, NamesTheSitesThatAreThere) {
    ExportConfig config = this->config();
    config.output /= "a.glb";
    config.site = "bob";
    EXPECT_NE(error_of(config).find("it has no site 'bob'; it has alice"), std::string::npos)
        << error_of(config);
}

TEST_F(RecordingExport, SaysWhenThereAreFrames) {
    ExportConfig config = this->config();
    config.output /= "a.glb";
    config.from_s = 0.1;
    config.to_s = 0.5;
    const std::string message = error_of(config);
    EXPECT_NE(message.find("no frame of site 'alice' from 0.10 to 0.50 s"), std::string::npos)
        << message;
    EXPECT_NE(message.find("has frames of it from 1.05 to 1.30 s"), std::string::npos) << message;
    EXPECT_EQ(written(), Names{});
}

TEST_F(RecordingExport, NeedsAPlaceForTheWorldAndForCameras) {
    testing::BallRecording content;
    content.has_placement = false;
    ExportConfig config = this->config(content);
    config.output /= "a.glb";
    config.frame = "world";
    EXPECT_NE(error_of(config).find("does not say where site 'alice' is in the world"),
              std::string::npos);
    config.frame = "site";
    EXPECT_EQ(error_of(config), "");
}

TEST_F(RecordingExport, LeavesNothingWhenItIsStopped) {
    ExportConfig config = this->config();
    std::stop_source stop;
    stop.request_stop();
    for (const char* name : {"a.glb", "a.usda"}) {
        config.output = folder_ / "out" / name;
        const auto done = run_export(config, stop.get_token());
        ASSERT_FALSE(done);
        EXPECT_NE(done.error().message.find("stopped after"), std::string::npos);
    }
    EXPECT_EQ(written(), Names{});
}

TEST_F(RecordingExport, SaysThatAFolderIsMissing) {
    ExportConfig config = this->config();
    config.output = folder_ / "none" / "a.glb";
    EXPECT_NE(error_of(config).find("create the folder"), std::string::npos) << error_of(config);
}

TEST(ExportFormat, ComesFromTheEndingOrTheOption) {
    const auto format = [](const char* output, const char* given = "auto") {
        ExportConfig config;
        config.file = "a.mcap";
        config.output = output;
        config.format = given;
        const auto good = check(config);
        return good ? *format_of(config) : "error: " + good.error().message;
    };
    EXPECT_EQ(format("a.glb"), "glb");
    EXPECT_EQ(format("a.usda"), "usd");
    EXPECT_EQ(format("a.obj"), "obj");
    EXPECT_EQ(format("a.ply"), "ply");
    EXPECT_EQ(format("a.ply", "points"), "points");
    EXPECT_EQ(format("folder", "obj"), "obj");
    EXPECT_EQ(format("monday.1", "ply"), "ply") << "a folder with a point in its name";
    EXPECT_TRUE(format("folder").starts_with("error: output: 'folder': the name must end in"));
    EXPECT_TRUE(format("a.fbx").starts_with("error: output: 'a.fbx'"));
    EXPECT_TRUE(format("folder", "glb").ends_with("must end in .glb"));
    EXPECT_TRUE(format("a.glb", "obj").ends_with("does not fit the ending of a.glb"));
}

TEST(ExportCheck, NamesWhatDoesNotFit) {
    ExportConfig config;
    const auto message = [&] {
        const auto good = check(config);
        return good ? "" : good.error().message;
    };
    EXPECT_TRUE(message().starts_with("FILE is missing"));
    config.file = "a.mcap";
    EXPECT_TRUE(message().starts_with("-o is missing"));
    config.output = "a.obj";
    EXPECT_EQ(message(), "");
    config.to_s = 3.0;
    EXPECT_NE(message().find("a.obj is one frame"), std::string::npos);
    config.output = "a.glb";
    EXPECT_EQ(message(), "");
    config.from_s = 4.0;
    EXPECT_TRUE(message().starts_with("to: must not be earlier"));
    config.from_s = 0.0;
    config.output = "a.usda";
    config.path = "p.json";
    EXPECT_TRUE(message().starts_with("path: only .glb files have cameras"));
    config.eye = "path";
    EXPECT_EQ(message(), "");
    config.path.clear();
    EXPECT_EQ(message(), "eye: 'path' needs --path PATH.json");
}

}  // namespace
}  // namespace atrium::exporting
