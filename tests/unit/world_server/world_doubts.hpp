#pragma once

#include "tests/support/world/load_world.hpp"
#include "world_server/description/doubts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace atrium::world_server {

inline constexpr const char* kRock =
    "[[object]]\nname = \"rock\"\nshape = \"convex\"\nmodel = \"rock.obj\"\nmass_kg = 50\n"
    "position_m = [0, 0, 0]\n";
inline constexpr const char* kFloor = "[[object]]\nname = \"floor\"\nshape = \"plane\"\n";

inline std::string box(const std::string& name, double mass_kg, const std::string& rest) {
    return "[[object]]\nname = \"" + name + "\"\nshape = \"box\"\nsize_m = [0.4, 0.4, 0.4]\n" +
           "mass_kg = " + std::to_string(mass_kg) + "\n" + rest + "\n";
}

/// A tetrahedron of two meshes, whose materials have no names. `materials`: of the two, then of the
/// file.
inline std::string tetrahedron_gltf(const std::string& first,
                                    const std::string& second,
                                    const std::string& materials) {
    const std::string bytes =
        "AAAAAAAAAAAAAAAAZmZmPwAAAAAAAAAAAAAAAGZmZj8AAAAAAAAAAAAAAABmZmY/AAACAA"
        "EAAAABAAMAAAADAAIAAQACAAMA";
    const auto mesh = [](int indices, const std::string& material) {
        return R"({"primitives":[{"attributes":{"POSITION":0},"indices":)" +
               std::to_string(indices) + material + "}]}";
    };
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],)"
           R"("nodes":[{"mesh":0},{"mesh":1}],"meshes":[)" +
           mesh(1, first) + "," + mesh(2, second) + "]," + materials +
           R"("buffers":[{"byteLength":72,"uri":"data:application/octet-stream;base64,)" + bytes +
           R"("}],"bufferViews":[{"buffer":0,"byteLength":48},)"
           R"({"buffer":0,"byteOffset":48,"byteLength":24}],"accessors":[)"
           R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)"
           R"("min":[0,0,0],"max":[0.9,0.9,0.9]},)"
           R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},)"
           R"({"bufferView":1,"byteOffset":12,"componentType":5123,"count":6,"type":"SCALAR"}]})";
}

/// What the server doubts in a world file. Models lie beside the file.
class WorldDoubts : public testing::Test {
protected:
    WorldDoubts() : folder_(std::filesystem::path(testing::TempDir()) / "world_doubts") {
        std::filesystem::create_directories(folder_);
        put("rock.obj",
            "mtllib paint.mtl\nusemtl paint\nv 0 0 0\nv 0.9 0 0\nv 0 0.9 0\nv 0 0 0.9\n"
            "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
        put("paint.mtl", "newmtl paint\nKd 0.2 0.5 0.3\nmap_Kd stone.png\n");
        put("own.png", "any bytes: only viewers look inside");
    }
    ~WorldDoubts() override { std::filesystem::remove_all(folder_); }

    void put(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }
    /// Without those about a missing floor and missing objects: most tests need neither.
    std::vector<std::string> doubts(const std::string& text) const {
        std::vector<std::string> lines = all_doubts(text);
        std::erase_if(lines, [](const std::string& line) {
            return line.find("nothing carries") != std::string::npos ||
                   line.find("has no objects") != std::string::npos;
        });
        return lines;
    }
    std::vector<std::string> all_doubts(const std::string& text) const {
        put("world.toml", text);
        const auto config = test_support::load_world(folder_ / "world.toml");
        EXPECT_TRUE(config) << config.error().message;
        return config ? doubts_about(*config, config->tick_hz)
                      : std::vector<std::string>{"not read"};
    }

    std::filesystem::path folder_;
};

}  // namespace atrium::world_server
