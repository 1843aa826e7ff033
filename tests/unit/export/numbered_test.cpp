#include "tests/support/temporary_folder.hpp"
#include "tests/unit/export/ball_person.hpp"
#include "tools/export/formats/numbered_writer.hpp"

#include <assimp/Importer.hpp>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <sstream>

namespace atrium::exporting {
namespace {

geometry::RigidTransform five_metres_along_x() {
    return {Eigen::Quaterniond::Identity(), {5, 0, 0}};
}

void write_two_frames(FrameWriter& writer) {
    const renderer::PersonModel model = testing::ball_model(8);
    for (std::size_t number : {1U, 2U}) {
        auto frame = writer.encode({model, five_metres_along_x(), {}}, testing::frame_time(number));
        ASSERT_TRUE(frame) << frame.error().message;
        const auto added = writer.add(std::move(*frame));
        ASSERT_TRUE(added) << added.error().message;
    }
    ASSERT_TRUE(writer.finish());
}

std::string text_of(const std::filesystem::path& file) {
    const auto bytes = testing::bytes_of(file);
    return {bytes.begin(), bytes.end()};
}

void expect_facts(const std::string& text) {
    for (const char* fact : {"frame_of_reference: site ball",
                             "units: m",
                             "axes: right-handed, +Z up",
                             "rate_hz: 20",
                             "frame: 2",
                             "time_s: 0.05",
                             "recording_s: 2.05",
                             "colours_for: surface normals",
                             "capture_time_ns: 1700000000050000000"})
        EXPECT_NE(text.find(fact), std::string::npos) << fact;
}

TEST(ObjWriter, WritesASequenceThatOtherProgramsRead) {
    const test::TemporaryFolder folder;
    auto writer = make_obj_writer({folder / "new" / "sequence", "ball"}, testing::facts());
    write_two_frames(*writer);
    const auto sequence = folder / "new" / "sequence";
    EXPECT_EQ(testing::names_in(sequence),
              (std::vector<std::string>{"ball_000001.jpg",
                                        "ball_000001.mtl",
                                        "ball_000001.obj",
                                        "ball_000002.jpg",
                                        "ball_000002.mtl",
                                        "ball_000002.obj"}));
    expect_facts(text_of(sequence / "ball_000002.obj"));
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile((sequence / "ball_000002.obj").string(), 0);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    ASSERT_EQ(scene->mNumMeshes, 1u);
    const aiMesh& mesh = *scene->mMeshes[0];
    EXPECT_EQ(mesh.mNumFaces, testing::ball_model(8).triangles.size());
    ASSERT_TRUE(mesh.HasTextureCoords(0));
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        const aiVector3D& p = mesh.mVertices[i];
        EXPECT_LT(testing::off_surface_m({p.x - 5.0, p.y, p.z}), 0.002);
    }
    aiString picture;
    ASSERT_EQ(
        scene->mMaterials[mesh.mMaterialIndex]->GetTexture(aiTextureType_DIFFUSE, 0, &picture),
        aiReturn_SUCCESS);
    EXPECT_STREQ(picture.C_Str(), "ball_000002.jpg");
}

TEST(ObjWriter, KeepsPositionsSharedAcrossCharts) {
    const test::TemporaryFolder folder;
    NumberedOptions options{folder / "", "one"};
    options.is_single = true;
    auto writer = make_obj_writer(options, testing::facts());
    const renderer::PersonModel model = testing::ball_model(8);
    auto frame = writer->encode({model, {}, {}}, testing::frame_time(1));
    ASSERT_TRUE(frame);
    ASSERT_TRUE(writer->add(std::move(*frame)));
    EXPECT_EQ(testing::names_in(folder / ""),
              (std::vector<std::string>{"one.jpg", "one.mtl", "one.obj"}));
    std::istringstream lines(text_of(folder / "one.obj"));
    std::size_t num_positions = 0;
    std::size_t num_uvs = 0;
    std::size_t triangle = 0;
    for (std::string line; std::getline(lines, line);) {
        num_positions += line.starts_with("v ");
        num_uvs += line.starts_with("vt ");
        if (!line.starts_with("f ")) continue;
        std::istringstream words(line.substr(2));
        for (std::size_t i = 0; i < 3; ++i) {
            std::size_t position = 0;
            std::size_t uv = 0;
            char slash = 0;
            words >> position >> slash >> uv;
            EXPECT_EQ(position, model.triangles[triangle][i] + 1);
            EXPECT_GE(uv, 1u);
            EXPECT_LE(uv, num_uvs);
        }
        ++triangle;
    }
    EXPECT_EQ(num_positions, model.vertices_site.size());
    EXPECT_EQ(triangle, model.triangles.size());
}

struct Ply {
    std::vector<std::string> header;
    std::vector<std::uint8_t> body;
};
Ply read_ply(const std::filesystem::path& file) {
    const auto bytes = testing::bytes_of(file);
    const std::string end = "end_header\n";
    const auto found = std::ranges::search(bytes, end);
    std::istringstream text(std::string(bytes.begin(), found.begin()));
    Ply ply;
    for (std::string line; std::getline(text, line);) ply.header.push_back(line);
    ply.body.assign(found.end(), bytes.end());
    return ply;
}
Eigen::Vector3f vector_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
    Eigen::Vector3f value;
    std::memcpy(value.data(), bytes.data() + at, 12);
    return value;
}

TEST(PlyWriter, WritesColouredTriangles) {
    const test::TemporaryFolder folder;
    auto writer = make_ply_writer({folder / "", "ball"}, testing::facts());
    write_two_frames(*writer);
    expect_facts(text_of(folder / "ball_000002.ply"));
    const Ply ply = read_ply(folder / "ball_000002.ply");
    const renderer::PersonModel model = testing::ball_model(8);
    EXPECT_EQ(ply.header[1], "format binary_little_endian 1.0");
    const std::size_t num_vertices = model.vertices_site.size();
    const std::size_t num_triangles = model.triangles.size();
    ASSERT_EQ(ply.body.size(), 15 * num_vertices + 13 * num_triangles);
    for (std::size_t v = 0; v < num_vertices; ++v) {
        const Eigen::Vector3f p = vector_at(ply.body, 15 * v);
        EXPECT_LT((p - Eigen::Vector3f(5, 0, 0) - model.vertices_site[v]).norm(), 1e-5f);
    }
    for (std::size_t t = 0; t < num_triangles; ++t) {
        const std::uint8_t* at = ply.body.data() + 15 * num_vertices + 13 * t;
        EXPECT_EQ(at[0], 3);
        std::array<std::uint32_t, 3> triangle{};
        std::memcpy(triangle.data(), at + 1, 12);
        EXPECT_EQ(triangle, model.triangles[t]);
    }
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile((folder / "ball_000001.ply").string(), 0);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    EXPECT_EQ(scene->mMeshes[0]->mNumFaces, num_triangles);
    EXPECT_TRUE(scene->mMeshes[0]->HasVertexColors(0));
}

TEST(PointsWriter, WritesPointsWithNormalsAndColours) {
    const test::TemporaryFolder folder;
    NumberedOptions options{folder / "", "ball"};
    options.num_points = 1000;
    auto writer = make_points_writer(options, testing::facts());
    const Eigen::AngleAxisd turn(1.0, Eigen::Vector3d::UnitZ());
    const geometry::RigidTransform turned{Eigen::Quaterniond(turn), {0, 0, 0}};
    auto frame = writer->encode({testing::ball_model(8), turned, {}}, testing::frame_time(2));
    ASSERT_TRUE(frame);
    ASSERT_TRUE(writer->add(std::move(*frame)));
    expect_facts(text_of(folder / "ball_000002.ply"));
    const Ply ply = read_ply(folder / "ball_000002.ply");
    ASSERT_EQ(ply.body.size(), 27u * 1000);
    EXPECT_EQ(std::ranges::count(ply.header, "element vertex 1000"), 1);
    int num_large = 0;
    for (std::size_t i = 0; i < 1000; ++i) {
        const Eigen::Vector3d p = turned.inverse() * vector_at(ply.body, 27 * i).cast<double>();
        EXPECT_LT(testing::off_surface_m(p), 0.04);
        const Eigen::Vector3d from_centre = p - testing::balls()[0].centre;
        if (from_centre.norm() > 0.52) continue;
        ++num_large;
        const Eigen::Vector3d normal =
            turned.rotation.conjugate() * vector_at(ply.body, 27 * i + 12).cast<double>();
        EXPECT_GT(normal.dot(from_centre.normalized()), 0.9);
    }
    EXPECT_GT(num_large, 700);
}

TEST(NumberedWriters, WriteAFrameWithoutAnybody) {
    const test::TemporaryFolder folder;
    NumberedOptions options{folder / "", "ball"};
    options.num_points = 10;
    for (auto make : {make_obj_writer, make_ply_writer, make_points_writer}) {
        auto writer = make(options, testing::facts());
        auto frame = writer->encode({renderer::PersonModel{}, {}, {}}, testing::frame_time(1));
        ASSERT_TRUE(frame) << frame.error().message;
        ASSERT_TRUE(writer->add(std::move(*frame)));
    }
    EXPECT_EQ(testing::names_in(folder / ""),
              (std::vector<std::string>{"ball_000001.obj", "ball_000001.ply"}));
    EXPECT_NE(text_of(folder / "ball_000001.ply").find("element vertex 0\n"), std::string::npos);
}

}  // namespace
}  // namespace atrium::exporting
