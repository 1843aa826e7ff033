// Model files that are cut off, damaged or something else.
#include "core/model/model_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

namespace atrium::model {
namespace {

using ::testing::HasSubstr;

class DamagedModels : public ::testing::Test {
protected:
    DamagedModels()
        : folder_(std::filesystem::path(::testing::TempDir()) /
                  ("damaged_models_" + std::to_string(getpid()))) {
        std::filesystem::create_directories(folder_);
    }
    ~DamagedModels() override { std::filesystem::remove_all(folder_); }

    std::string error_of(const std::string& name, const std::string& bytes) {
        const std::filesystem::path file = folder_ / name;
        std::ofstream(file, std::ios::binary) << bytes;
        const auto parts = load_model(file);
        return parts ? "" : parts.error().message;
    }

    // A square pyramid.
    static std::string ply(const std::string& last_faces) {
        return "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
               "property float z\nelement face 5\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 0.5 1\n4 0 3 2 1\n3 0 1 4\n" +
               last_faces;
    }

    std::filesystem::path folder_;
};

TEST_F(DamagedModels, Ply) {
    EXPECT_EQ(error_of("good.ply", ply("3 1 2 4\n3 2 3 4\n3 3 0 4\n")), "");
    // Assimp would never end
    const std::string whole = ply("");
    const std::size_t header = whole.find("end_header") + 10;
    for (std::size_t i = 1; i <= header; ++i)
        EXPECT_THAT(error_of("part.ply", whole.substr(0, i)), HasSubstr("its header does not end"))
            << i;
}

TEST_F(DamagedModels, PlyCutInItsData) {
    const std::string text = ply("3 1 2 4\n3 2 3 4\n3 3 0 4");
    EXPECT_EQ(error_of("no_newline.ply", text), "");
    EXPECT_THAT(error_of("cut.ply", ply("3 1 2 4\n")),
                HasSubstr("is cut off: has 3 of 5 entries of 'face'"));
    EXPECT_THAT(error_of("cut.ply", text.substr(0, text.find("0 1 0"))),
                HasSubstr("is cut off: has 3 of 5 entries of 'vertex'"));
    EXPECT_EQ(error_of("degenerate.ply", ply("3 1 2 4\n3 2 3 4\n3 3 3 4\n")), "");
    for (const bool is_big : {false, true}) {
        const auto number = [&](auto value) {
            std::string bytes(sizeof value, '\0');
            std::memcpy(bytes.data(), &value, sizeof value);
            if (is_big) std::reverse(bytes.begin(), bytes.end());
            return bytes;
        };
        std::string binary =
            std::string("ply\r\nformat binary_") + (is_big ? "big" : "little") +
            "_endian 1.0\r\ncomment made by hand\r\nelement vertex 4\r\nproperty float x\r\n"
            "property float y\r\nproperty float z\r\nproperty uchar red\r\nelement face 4\r\n"
            "property list uchar uint vertex_indices\r\nproperty short part\r\nend_header\r\n";
        for (const auto& [x, y, z] : {std::array{0.0F, 0.0F, 0.0F},
                                      {1.0F, 0.0F, 0.0F},
                                      {0.0F, 1.0F, 0.0F},
                                      {0.0F, 0.0F, 1.0F}})
            binary += number(x) + number(y) + number(z) + '\x80';
        const std::size_t faces = binary.size();
        for (const auto& [a, b, c] :
             {std::array{0U, 2U, 1U}, {0U, 1U, 3U}, {0U, 3U, 2U}, {1U, 2U, 3U}})
            binary += '\x03' + number(a) + number(b) + number(c) + number(std::int16_t{7});
        EXPECT_EQ(error_of("whole.ply", binary), "");
        EXPECT_THAT(error_of("cut.ply", binary.substr(0, binary.size() - 1)),
                    HasSubstr("is cut off: has 3 of 4 entries of 'face'"));
        EXPECT_THAT(error_of("cut.ply", binary.substr(0, faces)),
                    HasSubstr("is cut off: has 0 of 4 entries of 'face'"));
        EXPECT_THAT(error_of("cut.ply", binary.substr(0, faces - 1)),
                    HasSubstr("is cut off: has 3 of 4 entries of 'vertex'"));
    }
}

TEST_F(DamagedModels, Obj) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_EQ(error_of("good.obj", vertices + "f 1 2 3\n"), "");
    EXPECT_THAT(error_of("line.obj", vertices + "f 1 2 3\nf 1 2\n"), HasSubstr("line.obj: "));
    EXPECT_THAT(error_of("points.obj", vertices), HasSubstr("has no triangles"));
    EXPECT_THAT(error_of("empty.obj", ""), HasSubstr("is empty"));
}

TEST_F(DamagedModels, LengthsInHeaders) {
    std::string stl(84 + 50 * 4, '\0');
    stl[80] = 4;
    for (int i = 0; i < 4; ++i) {
        const std::array<float, 12> triangle{
            0, 0, 1, 0, 0, static_cast<float>(i), 1, 0, static_cast<float>(i), 0, 1, 0};
        std::memcpy(&stl[84 + 50 * static_cast<std::size_t>(i)], triangle.data(), 48);
    }
    EXPECT_EQ(error_of("good.stl", stl), "");
    EXPECT_THAT(error_of("cut.stl", stl.substr(0, 200)), HasSubstr("has 200 of 284 bytes"));
    std::string glb("glTF\x02\0\0\0\0\x10\0\0", 12);
    EXPECT_THAT(error_of("cut.glb", glb), HasSubstr("has 12 of 4096 bytes"));
}

TEST_F(DamagedModels, OtherFiles) {
    EXPECT_THAT(error_of("a.obj", "\x89PNG\r\n\x1a\n...."), HasSubstr("is a PNG picture"));
    EXPECT_THAT(error_of("b.obj", "glTF\x02"), HasSubstr("name it .glb"));
    EXPECT_THAT(error_of("c.gltf", "<!DOCTYPE html><html></html>"), HasSubstr("is a web page"));
    EXPECT_THAT(error_of("d.glb", "version https://git-lfs.github.com/spec/v1\n"),
                HasSubstr("git lfs pull"));
    EXPECT_THAT(error_of("e.glb", "hello"), HasSubstr("is damaged, or no .glb file"));
}

}  // namespace
}  // namespace atrium::model
