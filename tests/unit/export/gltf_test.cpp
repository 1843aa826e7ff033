#include "core/codec/textured_mesh_codec.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/export/ball_person.hpp"
#include "tools/export/formats/glb_writer.hpp"

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <map>
#include <numbers>
#include <set>

namespace atrium::exporting {
namespace {

using Json = nlohmann::json;

// A .glb as the specification of glTF 2.0 says it is. Checks the container and all references.
struct Glb {
    Json json;
    std::vector<std::uint8_t> binary;

    std::span<const std::uint8_t> view(int index) const {
        const Json& view = json["bufferViews"][static_cast<std::size_t>(index)];
        return std::span(binary).subspan(view.value("byteOffset", std::size_t{0}),
                                         view["byteLength"].get<std::size_t>());
    }
    std::vector<float> floats(int accessor) const {
        const Json& about = json["accessors"][static_cast<std::size_t>(accessor)];
        static const std::map<std::string, std::size_t> kComponents{
            {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
        EXPECT_EQ(about["componentType"], 5126);
        const auto bytes = view(about["bufferView"].get<int>());
        std::vector<float> values(about["count"].get<std::size_t>() *
                                  kComponents.at(about["type"].get<std::string>()));
        EXPECT_EQ(bytes.size(), values.size() * sizeof(float));
        std::memcpy(values.data(), bytes.data(), std::min(bytes.size(), 4 * values.size()));
        return values;
    }
};

std::uint32_t u32_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

Glb read_glb(const std::filesystem::path& file) {
    const std::vector<std::uint8_t> bytes = testing::bytes_of(file);
    Glb glb;
    EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 4), "glTF");
    EXPECT_EQ(u32_at(bytes, 4), 2u);
    EXPECT_EQ(u32_at(bytes, 8), bytes.size());
    const std::size_t json_size = u32_at(bytes, 12);
    EXPECT_EQ(json_size % 4, 0u);
    EXPECT_EQ(u32_at(bytes, 16), 0x4E4F534Au);
    glb.json = Json::parse(bytes.begin() + 20,
                           bytes.begin() + 20 + static_cast<std::ptrdiff_t>(json_size));
    if (20 + json_size < bytes.size()) {
        EXPECT_EQ(u32_at(bytes, 24 + json_size), 0x004E4942u);
        glb.binary.assign(bytes.begin() + 28 + static_cast<std::ptrdiff_t>(json_size), bytes.end());
        EXPECT_EQ(u32_at(bytes, 20 + json_size), glb.binary.size());
        EXPECT_EQ(glb.json["buffers"][0]["byteLength"], glb.binary.size());
    }
    for (const Json& view : glb.json["bufferViews"]) {
        EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
        EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(),
                  glb.binary.size());
        EXPECT_GT(view["byteLength"], 0);
    }
    return glb;
}

// Checks that what exporters like to get wrong is right: gltf-validator looks at the same.
void check_animations(const Glb& glb) {
    for (const Json& animation : glb.json.value("animations", Json::array())) {
        std::set<std::pair<int, std::string>> targets;
        for (const Json& channel : animation["channels"]) {
            EXPECT_LT(channel["target"]["node"], glb.json["nodes"].size());
            EXPECT_TRUE(targets
                            .emplace(channel["target"]["node"].get<int>(),
                                     channel["target"]["path"].get<std::string>())
                            .second);
            const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
            const Json& input = glb.json["accessors"][sampler["input"].get<std::size_t>()];
            EXPECT_EQ(input["count"],
                      glb.json["accessors"][sampler["output"].get<std::size_t>()]["count"]);
            const std::vector<float> times = glb.floats(sampler["input"].get<int>());
            EXPECT_TRUE(std::ranges::is_sorted(times, std::ranges::less_equal{}));
            EXPECT_GE(times.front(), 0.0f);
            EXPECT_EQ(input["min"][0].get<float>(), times.front());
            EXPECT_EQ(input["max"][0].get<float>(), times.back());
        }
    }
}

// Which nodes an animation shows at a time.
std::vector<std::string> shown_at(const Glb& glb, double time_s) {
    std::vector<std::string> shown;
    for (const Json& animation : glb.json["animations"]) {
        if (animation["name"] != "frames") continue;
        for (const Json& channel : animation["channels"]) {
            EXPECT_EQ(channel["target"]["path"], "scale");
            const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
            EXPECT_EQ(sampler["interpolation"], "STEP");
            const auto times = glb.floats(sampler["input"].get<int>());
            const auto scales = glb.floats(sampler["output"].get<int>());
            const auto later =
                std::ranges::upper_bound(times, static_cast<float>(time_s)) - times.begin();
            const auto key = static_cast<std::size_t>(std::max<std::ptrdiff_t>(later, 1) - 1);
            if (scales[3 * key] > 0.5f) {
                shown.push_back(
                    glb.json["nodes"][channel["target"]["node"].get<std::size_t>()]["name"]);
            }
        }
    }
    return shown;
}

Written write_frames(FrameWriter& writer, int num_frames) {
    const renderer::PersonModel model = testing::ball_model(8);
    for (int i = 1; i <= num_frames; ++i) {
        auto frame =
            writer.encode({model, {}, {}}, testing::frame_time(static_cast<std::size_t>(i)));
        EXPECT_TRUE(frame) << frame.error().message;
        const auto added = writer.add(std::move(*frame));
        EXPECT_TRUE(added) << added.error().message;
    }
    auto written = writer.finish();
    EXPECT_TRUE(written) << written.error().message;
    return std::move(*written);
}

CameraPath two_keys() {
    CameraPath path;
    path.fov_rad = 0.7;
    path.keys.push_back({0.0, {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {-3, 0, 1}}});
    path.keys.push_back({0.1, {Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5), {-3, 1, 1}}});
    return path;
}

TEST(GlbWriter, ShowsEachFrameAtItsTime) {
    const test::TemporaryFolder folder;
    auto writer = make_glb_writer({folder / "a.glb"}, testing::facts(), std::nullopt);
    const Written written = write_frames(*writer, 3);
    EXPECT_EQ(testing::names_in(folder / ""), (std::vector<std::string>{"a.glb"}));
    EXPECT_EQ(written.bytes, std::filesystem::file_size(folder / "a.glb"));
    const Glb glb = read_glb(folder / "a.glb");
    check_animations(glb);
    using Names = std::vector<std::string>;
    EXPECT_EQ(shown_at(glb, 0.0), Names{"ball_000001"});
    EXPECT_EQ(shown_at(glb, 0.049), Names{"ball_000001"});
    EXPECT_EQ(shown_at(glb, 0.051), Names{"ball_000002"});
    EXPECT_EQ(shown_at(glb, 0.11), Names{"ball_000003"});
    EXPECT_EQ(shown_at(glb, 9.0), Names{"ball_000003"});
    const Json& extras = glb.json["asset"]["extras"];
    EXPECT_EQ(extras["frame_of_reference"], "site ball");
    EXPECT_EQ(extras["units"], "m");
    EXPECT_EQ(extras["rate_hz"], 20.0);
    EXPECT_EQ(glb.json["nodes"][2]["extras"]["recording_s"], 2.05);
    EXPECT_EQ(glb.json["extensionsRequired"], Json{"KHR_draco_mesh_compression"});
    // every extension that is used somewhere is named
    EXPECT_EQ(glb.json["extensionsUsed"],
              (Json{"KHR_materials_unlit", "KHR_draco_mesh_compression"}));
}

TEST(GlbWriter, StatesWhatItsDracoMeshesHave) {
    const test::TemporaryFolder folder;
    auto writer = make_glb_writer({folder / "a.glb"}, testing::facts(), std::nullopt);
    write_frames(*writer, 1);
    const Glb glb = read_glb(folder / "a.glb");
    const Json& primitive = glb.json["meshes"][0]["primitives"][0];
    const Json& draco = primitive["extensions"]["KHR_draco_mesh_compression"];
    EXPECT_EQ(draco["attributes"]["POSITION"], codec::kDracoPositionId);
    EXPECT_EQ(draco["attributes"]["TEXCOORD_0"], codec::kDracoUvId);
    const auto mesh = codec::decode_textured(glb.view(draco["bufferView"].get<int>()));
    ASSERT_TRUE(mesh) << mesh.error().message;
    const auto accessor = [&](const Json& index) {
        return glb.json["accessors"][index.get<std::size_t>()];
    };
    const Json positions = accessor(primitive["attributes"]["POSITION"]);
    EXPECT_EQ(positions["count"], mesh->positions.size());
    EXPECT_EQ(accessor(primitive["attributes"]["TEXCOORD_0"])["count"], mesh->uvs.size());
    EXPECT_EQ(accessor(primitive["indices"])["count"], 3 * mesh->triangles.size());
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& p : mesh->positions) {
        box.extend(p);
        EXPECT_LT(testing::off_surface_m(p.cast<double>()), 0.002);
    }
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        EXPECT_FLOAT_EQ(positions["min"][axis].get<float>(), box.min()[i]);
        EXPECT_FLOAT_EQ(positions["max"][axis].get<float>(), box.max()[i]);
    }
    const auto jpeg = glb.view(glb.json["images"][0]["bufferView"].get<int>());
    EXPECT_EQ(jpeg[0], 0xFF);
    EXPECT_EQ(jpeg[1], 0xD8);
}

TEST(GlbWriter, GoesOnInFurtherFiles) {
    const test::TemporaryFolder folder;
    GlbOptions options{folder / "a.glb"};
    options.file_frames = 2;
    auto writer = make_glb_writer(options, testing::facts(), two_keys());
    write_frames(*writer, 5);
    EXPECT_EQ(testing::names_in(folder / ""),
              (std::vector<std::string>{"a_001.glb", "a_002.glb", "a_003.glb"}));
    // all in one scene show one sequence
    const std::array files{read_glb(folder / "a_001.glb"),
                           read_glb(folder / "a_002.glb"),
                           read_glb(folder / "a_003.glb")};
    for (int i = 0; i < 5; ++i) {
        std::vector<std::string> shown;
        for (const Glb& glb : files) {
            check_animations(glb);
            for (const std::string& name : shown_at(glb, 0.05 * i + 0.01)) shown.push_back(name);
        }
        EXPECT_EQ(shown, std::vector<std::string>{"ball_00000" + std::to_string(i + 1)});
    }
    EXPECT_TRUE(files[0].json.contains("cameras"));
    EXPECT_FALSE(files[1].json.contains("cameras"));
}

TEST(GlbWriter, BeginsAnotherFileWhenOneIsFull) {
    const test::TemporaryFolder folder;
    GlbOptions options{folder / "a.glb"};
    options.file_bytes = 60'000;
    auto writer = make_glb_writer(options, testing::facts(), std::nullopt);
    const Written written = write_frames(*writer, 8);
    ASSERT_GT(written.files.size(), 1u);
    for (const auto& file : written.files) EXPECT_LT(std::filesystem::file_size(file), 70'000u);
}

TEST(GlbWriter, LeavesNothingWithoutItsEnd) {
    const test::TemporaryFolder folder;
    auto writer = make_glb_writer({folder / "a.glb"}, testing::facts(), std::nullopt);
    auto frame = writer->encode({testing::ball_model(6), {}, {}}, testing::frame_time(1));
    ASSERT_TRUE(frame);
    ASSERT_TRUE(writer->add(std::move(*frame)));
    writer.reset();
    EXPECT_TRUE(testing::names_in(folder / "").empty());
}

TEST(GlbWriter, CamerasLookWhereThePathLooks) {
    const test::TemporaryFolder folder;
    auto writer = make_glb_writer({folder / "a.glb"}, testing::facts(), two_keys());
    write_frames(*writer, 3);
    const Glb glb = read_glb(folder / "a.glb");
    check_animations(glb);
    EXPECT_NEAR(glb.json["cameras"][0]["perspective"]["yfov"].get<double>(), 0.7, 1e-9);
    const Json& animation = glb.json["animations"][1];
    const auto turns = glb.floats(animation["samplers"][1]["output"].get<int>());
    const auto places = glb.floats(animation["samplers"][0]["output"].get<int>());
    ASSERT_EQ(turns.size(), 8u);
    EXPECT_EQ((std::vector<float>{places[3], places[4], places[5]}),
              (std::vector<float>{-3, 1, 1}));
    float dot = 0.0f;
    for (std::size_t i = 0; i < 4; ++i) dot += turns[i] * turns[4 + i];
    EXPECT_NEAR(dot, 1.0f, 1e-5f) << "the same turn has the same sign, else players turn around";
    const Eigen::Quaternionf frame_from_gltf(turns[3], turns[0], turns[1], turns[2]);
    const Eigen::Matrix3f frame_from_camera =
        two_keys().keys[0].frame_from_camera.rotation.toRotationMatrix().cast<float>();
    const Eigen::Vector3f forward = frame_from_gltf * Eigen::Vector3f(0, 0, -1);
    const Eigen::Vector3f up = frame_from_gltf * Eigen::Vector3f(0, 1, 0);
    EXPECT_LT((forward - frame_from_camera.col(2)).norm(), 1e-5f);
    EXPECT_LT((up + frame_from_camera.col(1)).norm(), 1e-5f);
}

TEST(GlbWriter, KeepsAFrameWithoutAnybody) {
    const test::TemporaryFolder folder;
    auto writer = make_glb_writer({folder / "a.glb"}, testing::facts(), std::nullopt);
    for (std::size_t number = 1; number <= 2; ++number) {
        auto frame =
            writer->encode({number == 1 ? testing::ball_model(6) : renderer::PersonModel{}, {}, {}},
                           testing::frame_time(number));
        ASSERT_TRUE(frame) << frame.error().message;
        ASSERT_TRUE(writer->add(std::move(*frame)));
    }
    ASSERT_TRUE(writer->finish());
    const Glb glb = read_glb(folder / "a.glb");
    EXPECT_EQ(glb.json["meshes"].size(), 1u);
    EXPECT_EQ(shown_at(glb, 0.06), std::vector<std::string>{"ball_000002"});
    EXPECT_FALSE(glb.json["nodes"][2].contains("mesh"));
}

TEST(GlbWriter, OtherProgramsSeeTheMeshUprightInMetres) {
    const test::TemporaryFolder folder;
    GlbOptions options{folder / "a.glb"};
    options.has_draco = false;  // Debian's Assimp reads no Draco
    auto writer = make_glb_writer(options, testing::facts(), std::nullopt);
    write_frames(*writer, 1);
    Assimp::Importer importer;
    const aiScene* scene =
        importer.ReadFile((folder / "a.glb").string(), aiProcess_PreTransformVertices);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    ASSERT_EQ(scene->mNumMeshes, 1u);
    const aiMesh& mesh = *scene->mMeshes[0];
    const renderer::PersonModel model = testing::ball_model(8);
    EXPECT_EQ(mesh.mNumFaces, model.triangles.size());
    ASSERT_TRUE(mesh.HasTextureCoords(0));
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        const aiVector3D& p = mesh.mVertices[i];
        EXPECT_LT(testing::off_surface_m({p.x, -p.z, p.y}), 0.002);
        EXPECT_GE(mesh.mTextureCoords[0][i].x, 0.0f);
        EXPECT_LE(mesh.mTextureCoords[0][i].x, 1.0f);
    }
    EXPECT_EQ(scene->mNumTextures, 1u);
}

}  // namespace
}  // namespace atrium::exporting
