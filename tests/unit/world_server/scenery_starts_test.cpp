#include "tests/unit/world_server/world_doubts.hpp"

#include <fmt/format.h>

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A box of `size_m` on the floor around the origin, as an OBJ file of quads. The top is the second
/// one. The first vertex has the number `first`.
std::string obj_box(const Eigen::Vector3d& size_m, bool is_inwards = false, int first = 1) {
    std::string text;
    for (int i = 0; i < 8; ++i) {
        text += fmt::format("v {} {} {}\n",
                            size_m.x() * ((i & 1) - 0.5),
                            size_m.y() * ((i >> 1 & 1) - 0.5),
                            size_m.z() * (i >> 2));
    }
    constexpr int kQuads[6][4] = {
        {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}};
    for (const auto& [a, b, c, d] : kQuads) {
        text += is_inwards
                    ? fmt::format("f {} {} {} {}\n", d + first, c + first, b + first, a + first)
                    : fmt::format("f {} {} {} {}\n", a + first, b + first, c + first, d + first);
    }
    return text;
}

/// What is doubted about things in solid scenery.
class SceneryStarts : public WorldDoubts {
protected:
    std::vector<std::string> doubts_in(const std::string& obj, const std::string& things) {
        put("s.obj", obj);
        return doubts("[[scenery]]\nname = \"s\"\nmodel = \"s.obj\"\nsolid = true\n" + things);
    }
    static std::string crate(double height_m) {
        return "[[object]]\nname = \"crate\"\nshape = \"box\"\nsize_m = [0.2, 0.2, 0.2]\n"
               "mass_kg = 1\n" +
               fmt::format("position_m = [0.4, 0, {}]\n", height_m);
    }
    static std::string cushion(double height_m) {
        return "[[soft]]\nname = \"cushion\"\nshape = \"box\"\nsize_m = [0.6, 0.5, 0.16]\n"
               "mass_kg = 1\n" +
               fmt::format("position_m = [-0.6, 0, {}]\n", height_m);
    }
    const std::string stage_ = obj_box({3, 2, 0.4});
};

TEST_F(SceneryStarts, NameAnObjectInItsSurface) {
    put("post.obj", obj_box({0.2, 0.2, 2}));
    const std::string post = "[[scenery]]\nname = \"post\"\nmodel = \"post.obj\"\n";
    const std::string in_it = box("b", 1, "position_m = [0.2, 0, 1]");
    EXPECT_THAT(doubts(post + "solid = true\n" + in_it),
                ElementsAre(HasSubstr("object_looks_wrong name=b reason=\"starts 0.10 m inside "
                                      "post, which is solid scenery")));
    EXPECT_THAT(doubts(post + "solid = false\n" + in_it), IsEmpty());
    EXPECT_THAT(doubts(post + "solid = true\n" + box("b", 0, "position_m = [0.2, 0, 1]")),
                IsEmpty())
        << "a fixed object may stand in it";
    EXPECT_THAT(doubts(post + "solid = true\n" + box("b", 1, "position_m = [0.31, 0, 1]") +
                       box("on", 1, "position_m = [0, 0, 2.2]")),
                IsEmpty())
        << "beside and on it";
}

TEST_F(SceneryStarts, NameAnObjectInsideAClosedBody) {
    EXPECT_THAT(
        doubts_in(stage_, crate(0.2)),
        ElementsAre(HasSubstr("object_looks_wrong name=crate reason=\"starts 0.20 m inside s, "
                              "which is solid scenery of 3 x 2 x 0.4 m: check its scale, or, if "
                              "that is right: move it with position_m")));
    EXPECT_THAT(doubts_in(stage_, crate(0.35)), ElementsAre(HasSubstr("starts 0.15 m inside s")))
        << "it sticks out";
    EXPECT_THAT(doubts_in(stage_, crate(0.46)), IsEmpty()) << "4 cm deep";
    EXPECT_THAT(doubts_in(stage_, crate(0.5)), IsEmpty()) << "on it";
}

TEST_F(SceneryStarts, NameAModelInsideAClosedBody) {
    put("bar.obj", obj_box({0.1, 0.1, 0.3}));
    const auto bar = [](double height_m) {
        return "[[object]]\nname = \"bar\"\nshape = \"convex\"\nmodel = \"bar.obj\"\n"
               "mass_kg = 1\n" +
               fmt::format("position_m = [0, 0, {}]\n", height_m);
    };
    EXPECT_THAT(doubts_in(stage_, bar(0.05)),
                ElementsAre(AllOf(HasSubstr("starts 0.20 m inside s"),
                                  HasSubstr("the place of its file's origin"))));
    EXPECT_THAT(doubts_in(stage_, bar(0.4)), IsEmpty());
}

TEST_F(SceneryStarts, NameASoftObjectInsideAClosedBody) {
    EXPECT_THAT(
        doubts_in(stage_, cushion(0.2)),
        ElementsAre(HasSubstr("soft_looks_wrong name=cushion reason=\"starts 0.17 m inside s, "
                              "which is solid scenery of 3 x 2 x 0.4 m: check its scale, or, if "
                              "that is right: move it with position_m\"")));
    EXPECT_THAT(doubts_in(stage_, cushion(0.43)),
                ElementsAre(HasSubstr("name=cushion reason=\"starts 0.05 m inside s")));
    EXPECT_THAT(doubts_in(stage_, cushion(0.46)), IsEmpty()) << "2 cm deep";
    const std::string curtain =
        "[[soft]]\nname = \"curtain\"\nshape = \"cloth\"\nsize_m = [0.6, 0.6]\nmass_kg = 0.2\n"
        "spacing_m = 0.1\nposition_m = [0, 0, 0.61]\n";
    EXPECT_THAT(doubts_in(stage_, curtain), ElementsAre(HasSubstr("name=curtain")));
    EXPECT_THAT(doubts_in(stage_, curtain + "pins = [\"bottom\"]\n"), IsEmpty())
        << "only its pinned edge is inside";
}

TEST_F(SceneryStarts, NameAPuppetOnce) {
    const auto puppet = [](double height_m) {
        return "[[puppet]]\nname = \"pierrot\"\nheight_m = 0.7\n" +
               fmt::format("position_m = [0, 0, {}]\n", height_m);
    };
    EXPECT_THAT(doubts_in(stage_, puppet(0.4)), IsEmpty());
    EXPECT_THAT(
        doubts_in(stage_, puppet(0.0)),
        ElementsAre(AllOf(HasSubstr("object_looks_wrong name=pierrot reason=\"its thigh_l starts "
                                    "0.18 m inside s, which is solid scenery"),
                          HasSubstr("move the puppet with position_m, the place between its "
                                    "feet"))));
    EXPECT_THAT(doubts(kFloor + puppet(-0.2)),
                ElementsAre(HasSubstr("name=pierrot reason=\"its foot_l starts 0.20 m inside "
                                      "floor, which is fixed: move the puppet")));
}

TEST_F(SceneryStarts, LetThingsStandInRooms) {
    const std::string things = crate(0.2) + cushion(0.2);
    EXPECT_THAT(doubts_in(obj_box({6, 5, 3}, true), things), IsEmpty()) << "a room";
    EXPECT_THAT(doubts_in(obj_box({6, 5, 3}), things), IsEmpty()) << "modelled from outside";
    EXPECT_THAT(doubts_in(obj_box({6, 5, 0.5}, true), things), IsEmpty()) << "a tub with a lid";
    EXPECT_THAT(doubts_in(obj_box({6, 5, 3}, true) + obj_box({3, 2, 0.4}, false, 9), crate(0.2)),
                ElementsAre(HasSubstr("name=crate reason=\"starts 0.20 m inside s")))
        << "in the furniture of a room";
}

TEST_F(SceneryStarts, LetThingsBeBehindOpenSurfaces) {
    const std::string things = crate(0.2) + cushion(0.2);
    std::string open = stage_;
    const std::string top = "f 5 6 8 7\n";
    open.erase(open.find(top), top.size());
    EXPECT_THAT(doubts_in(open, things), IsEmpty()) << "a tub without a lid";
    const std::string sheet = "v -3 -3 0.5\nv 3 -3 0.5\nv 3 3 0.5\nv -3 3 0.5\nf 1 2 3 4\n";
    EXPECT_THAT(doubts_in(sheet, things), IsEmpty()) << "a table top";
}

// A crate of 0.2 m on a stage whose top is 0.4 m above the floor.
TEST_F(SceneryStarts, NameWhatStandsOnSceneryThatIsNotSolid) {
    put("s.obj", stage_);
    const auto on_stage = [&](double height_m, const std::string& more, const char* solid = "") {
        return doubts(std::string(kFloor) + "[[scenery]]\nname = \"s\"\nmodel = \"s.obj\"\n" +
                      solid + crate(height_m) + more);
    };
    const auto named = ElementsAre(
        HasSubstr("object_looks_wrong name=crate reason=\"starts on s, scenery that is not solid, "
                  "and falls through it: write solid = true for s\""));
    EXPECT_THAT(on_stage(0.5, ""), named);
    EXPECT_THAT(on_stage(0.515, ""), named);
    EXPECT_THAT(on_stage(0.5, "", "solid = true\n"), IsEmpty());
    EXPECT_THAT(on_stage(0.9, ""), IsEmpty()) << "it falls from above";
    EXPECT_THAT(on_stage(0.1, ""), IsEmpty()) << "it stands on the floor, in the stage";
    const std::string board =
        "[[object]]\nname = \"board\"\nshape = \"box\"\nsize_m = [1, 1, 0.1]\n"
        "mass_kg = 0\nposition_m = [0.4, 0, 0.35]\n";
    EXPECT_THAT(on_stage(0.5, board), IsEmpty()) << "on an invisible board";
    const std::string hinge =
        "[[joint]]\nkind = \"hinge\"\na = \"crate\"\nanchor_m = [0.4, 0, 0.6]\n"
        "axis = [1, 0, 0]\n";
    EXPECT_THAT(on_stage(0.5, hinge), IsEmpty()) << "it hangs";
}

}  // namespace
}  // namespace atrium::world_server
