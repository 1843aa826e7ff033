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
