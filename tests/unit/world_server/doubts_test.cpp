#include "world_server/description/doubts.hpp"

#include "tests/support/world/load_world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace atrium::world_server {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kPainted =
    "mtllib paint.mtl\nusemtl paint\nv 0 0 0\nv 0.9 0 0\nv 0 0.9 0\nv 0 0 0.9\n"
    "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
constexpr const char* kRock =
    "[[object]]\nname = \"rock\"\nshape = \"convex\"\nmodel = \"rock.obj\"\nmass_kg = 50\n"
    "position_m = [0, 0, 0]\n";

class WorldDoubts : public testing::Test {
protected:
    WorldDoubts() : folder_(fs::path(testing::TempDir()) / "world_doubts") {
        fs::create_directories(folder_);
        put("rock.obj", kPainted);
        put("paint.mtl", "newmtl paint\nKd 0.2 0.5 0.3\nmap_Kd stone.png\n");
        put("own.png", "any bytes: only viewers look inside");
    }
    ~WorldDoubts() override { fs::remove_all(folder_); }

    void put(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }
    std::vector<std::string> doubts(const std::string& text) const {
        put("world.toml", text);
        const auto config = test_support::load_world(folder_ / "world.toml");
        EXPECT_TRUE(config) << config.error().message;
        return config ? doubts_about(*config) : std::vector<std::string>{"not read"};
    }

    fs::path folder_;
};

TEST_F(WorldDoubts, NameATextureOfAModelFileThatIsNotDrawn) {
    EXPECT_THAT(doubts(kRock),
                ElementsAre(AllOf(HasSubstr("texture_not_drawn model=rock.obj"),
                                  HasSubstr("names=\"stone.png\""))));
    EXPECT_THAT(doubts(std::string(kRock) + "texture = \"own.png\"\n"), IsEmpty());
    EXPECT_THAT(doubts("[[scenery]]\nname = \"s\"\nmodel = \"rock.obj\"\n"),
                ElementsAre(HasSubstr("texture_not_drawn")));
}

TEST_F(WorldDoubts, NameAJointOutsideTheWorld) {
    const std::string joint = std::string(kRock) +
                              "texture = \"own.png\"\n[[joint]]\nkind = \"hinge\"\na = \"rock\"\n"
                              "axis = [0, 0, 1]\n";
    EXPECT_THAT(doubts(joint + "anchor_m = [0.5, 0, 0]\n"), IsEmpty());
    EXPECT_THAT(doubts(joint + "anchor_m = [500, 0, 0]\n"),
                ElementsAre(HasSubstr("joint_looks_wrong a=rock b=world "
                                      "reason=\"anchor_m [500, 0, 0] is outside")));
}

TEST_F(WorldDoubts, NameASliderThatIsLongerThanTheWorld) {
    const std::string slider = std::string(kRock) +
                               "texture = \"own.png\"\n[[joint]]\nkind = \"slider\"\na = \"rock\"\n"
                               "axis = [1, 0, 0]\nanchor_m = [0, 0, 0]\n";
    EXPECT_THAT(doubts(slider), IsEmpty());
    EXPECT_THAT(doubts(slider + "limits_m = [0, 0.4]\n"), IsEmpty());
    EXPECT_THAT(doubts(slider + "limits_m = [0, 400]\n"),
                ElementsAre(HasSubstr("limits_m [0, 400] are further apart")));
}

TEST_F(WorldDoubts, NameASoftModelOfLargeTriangles) {
    const std::string soft =
        "[[soft]]\nname = \"jelly\"\nshape = \"model\"\nmodel = \"rock.obj\"\nmass_kg = 1\n"
        "texture = \"own.png\"\nposition_m = [0, 0, 1]\n";
    EXPECT_THAT(doubts(soft),
                ElementsAre(AllOf(HasSubstr("soft_looks_wrong name=jelly model=rock.obj"),
                                  HasSubstr("are 1.1 m long"))));
    EXPECT_THAT(doubts(soft + "scale = 0.1\n"), IsEmpty());
}

}  // namespace
}  // namespace atrium::world_server
