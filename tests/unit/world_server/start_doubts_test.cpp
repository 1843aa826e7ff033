#include "tests/unit/world_server/world_doubts.hpp"

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(WorldDoubts, NameAnObjectThatStartsInsideAFixedOne) {
    EXPECT_THAT(doubts(kFloor + box("b", 1, "position_m = [0, 0, 0.16]")), IsEmpty());
    EXPECT_THAT(doubts(kFloor + box("b", 1, "position_m = [0, 0, 0.1]")),
                ElementsAre(HasSubstr("object_looks_wrong name=b reason=\"starts 0.10 m inside "
                                      "floor")));
    EXPECT_THAT(doubts(kFloor + box("b", 0, "position_m = [0, 0, 0.1]")), IsEmpty())
        << "a fixed object may stand in the floor";
    EXPECT_THAT(
        doubts(kFloor + box("b", 1, "position_m = [0, 0, 0.22]\nroll_pitch_yaw_deg = [45, 0, 0]")),
        ElementsAre(HasSubstr("starts 0.06 m inside floor")))
        << "its lower edge is 0.28 m below its middle";
    const std::string wall = box("wall", 0, "position_m = [0.3, 0, 1]");
    EXPECT_THAT(doubts(wall + box("b", 1, "position_m = [-0.08, 0, 1]")), IsEmpty());
    EXPECT_THAT(doubts(wall + box("b", 1, "position_m = [0, 0, 1]")),
                ElementsAre(HasSubstr("name=b reason=\"starts 0.10 m inside wall")));
    const std::string joint =
        "[[joint]]\nkind = \"ball\"\na = \"b\"\nb = \"wall\"\nanchor_m = [0.1, 0, 1]\n";
    EXPECT_THAT(doubts(wall + box("b", 1, "position_m = [0, 0, 1]") + joint), IsEmpty())
        << "joined objects do not touch each other";
    EXPECT_THAT(doubts(wall + box("b", 1, "position_m = [0, 0, 1]") + joint + "collide = true\n"),
                ElementsAre(HasSubstr("object_looks_wrong name=b")));
}

TEST_F(WorldDoubts, NameAModelThatLiesOnItsSideInTheFloor) {
    // a flat board, 4 cm high along +Y, at z = 0.03
    put("board.obj",
        "v -0.5 0 -0.3\nv 0.5 0 -0.3\nv 0.5 0 0.3\nv -0.5 0 0.3\n"
        "v -0.5 0.04 -0.3\nv 0.5 0.04 -0.3\nv 0.5 0.04 0.3\nv -0.5 0.04 0.3\n"
        "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n");
    const std::string board =
        std::string(kFloor) +
        "[[object]]\nname = \"board\"\nshape = \"convex\"\nmodel = \"board.obj\"\nmass_kg = 5\n";
    EXPECT_THAT(
        doubts(board + "position_m = [0, 0, 0.03]\n"),
        ElementsAre(AllOf(HasSubstr("starts 0.27 m inside floor"),
                          HasSubstr("its file may have +Y up: then write roll_pitch_yaw_deg = "
                                    "[90, 0, 0]"))));
    EXPECT_THAT(doubts(board + "position_m = [0, 0, 0.03]\nroll_pitch_yaw_deg = [90, 0, 0]\n"),
                IsEmpty());
    EXPECT_THAT(doubts(board + "position_m = [0, 0, -0.5]\n"),
                ElementsAre(HasSubstr("which is fixed: move it with position_m, the place of its "
                                      "file's origin")))
        << "turning it does not help";
}

TEST_F(WorldDoubts, NameMovingObjectsThatStartInsideEachOther) {
    const std::string a = box("a", 1, "position_m = [0, 0, 1]");
    EXPECT_THAT(doubts(a + box("b", 1, "position_m = [0.36, 0, 1]")), IsEmpty());
    const std::string b = box("b", 1, "position_m = [0.3, 0, 1]");
    EXPECT_THAT(doubts(a + b),
                ElementsAre(HasSubstr("object_looks_wrong name=b reason=\"starts 0.10 m inside a, "
                                      "which throws both apart")));
    const std::string joint =
        "[[joint]]\nkind = \"ball\"\na = \"a\"\nb = \"b\"\nanchor_m = [0.15, 0, 1]\n";
    EXPECT_THAT(doubts(a + b + joint), IsEmpty()) << "joined objects do not touch each other";
}

TEST_F(WorldDoubts, NameFixedObjectsAndSitesOutsideTheBounds) {
    EXPECT_THAT(doubts(box("bench", 0, "position_m = [-300, 1000, 800]")),
                ElementsAre(HasSubstr("object_looks_wrong name=bench reason=\"it is outside the "
                                      "world's bounds, [")));
    EXPECT_THAT(doubts(box("wall", 0, "position_m = [-20.1, 0, 1]")), IsEmpty()) << "at their edge";
    const std::string site = "[[site]]\nname = \"alice\"\n";
    EXPECT_THAT(
        doubts(site + "position_m = [40, 0, 0]\n"),
        ElementsAre(HasSubstr("site_looks_wrong name=alice reason=\"its place is outside")));
    EXPECT_THAT(doubts(site + "position_m = [4, 0, 0]\n"), IsEmpty());
}

TEST_F(WorldDoubts, NameASiteThatIsGivenARight) {
    const std::string site = "[[site]]\nname = \"alice\"\nposition_m = [0, 0, 0]\n";
    EXPECT_THAT(doubts(site + "[rights]\ngrab = [\"host\", \"alice\"]\n"),
                ElementsAre(HasSubstr("rights_looks_wrong right=grab name=alice")));
    EXPECT_THAT(doubts(site + "[rights]\ngrab = [\"host\"]\n"), IsEmpty());
}

TEST_F(WorldDoubts, NameSomethingLightThatCarriesSomethingHeavy) {
    const auto tower = [](double middle_kg, double top_kg, double top_m = 1.0) {
        return kFloor + box("a", 45, "position_m = [0, 0, 0.2]") +
               box("b", middle_kg, "position_m = [0, 0, 0.6]") +
               box("c", top_kg, "position_m = [0, 0, " + std::to_string(top_m) + "]");
    };
    EXPECT_THAT(doubts(tower(1, 90)), IsEmpty());
    EXPECT_THAT(doubts(tower(0.5, 60)),
                ElementsAre(AllOf(
                    HasSubstr("object_looks_wrong name=b reason=\"its 0.5 kg carry 60 kg, 120 "
                              "times as much; the heaviest is c with 60 kg: it slides or falls "
                              "above 100 times at world.tick_hz = 120"),
                    HasSubstr("make b at least 0.63 kg, or run with world.tick_hz = 240"))));
    EXPECT_THAT(
        doubts(tower(0.5, 2) + box("d", 60, "position_m = [0, 0, 1.4]")),
        ElementsAre(HasSubstr("carry 62 kg, 124 times as much; the heaviest is d with 60")));
    EXPECT_THAT(doubts("[world]\ntick_hz = 240.0\n" + tower(0.5, 60)), IsEmpty());
    EXPECT_THAT(doubts(tower(0.5, 60, 1.1)), IsEmpty()) << "the top is in the air";
    EXPECT_THAT(doubts(tower(0.5, 60) + box("d", 0, "position_m = [0.38, 0, 0.6]")), IsEmpty())
        << "a fixed box carries half of it";
    EXPECT_THAT(doubts(tower(0.5, 40) + box("d", 30, "position_m = [0, 0, 1.4]")),
                ElementsAre(HasSubstr("name=b reason=\"its 0.5 kg carry 70 kg, 140 times")));
}

TEST_F(WorldDoubts, NameALinkThatCarriesSomethingHeavy) {
    const auto chain = [](double weight_kg) {
        return box("l", 0.5, "position_m = [0, 0, 2]") + box("m", 0.4, "position_m = [0, 0, 1.6]") +
               box("w", weight_kg, "position_m = [0, 0, 1.2]") +
               "[[joint]]\nkind = \"ball\"\na = \"m\"\nb = \"l\"\nanchor_m = [0, 0, 1.8]\n"
               "[[joint]]\nkind = \"ball\"\na = \"w\"\nb = \"m\"\nanchor_m = [0, 0, 1.4]\n";
    };
    const std::string hook = "[[joint]]\nkind = \"ball\"\na = \"l\"\nanchor_m = [0, 0, 2.2]\n";
    EXPECT_THAT(doubts(chain(19) + hook), IsEmpty());
    EXPECT_THAT(
        doubts(chain(40) + hook),
        ElementsAre(AllOf(HasSubstr("object_looks_wrong name=m reason=\"its 0.4 kg carry "
                                    "40 kg, 100 times as much; the heaviest is w"),
                          HasSubstr("stretch or tear above 50 times"),
                          HasSubstr("make m and the links like it at least 0.84 kg, or run with "
                                    "world.tick_hz = 240"))))
        << "one line for a chain";
    EXPECT_THAT(doubts(chain(1500) + hook), ElementsAre(Not(HasSubstr("or run"))));
    EXPECT_THAT(doubts(chain(40)), IsEmpty()) << "hangs from nothing";
    const std::string other_end = "[[joint]]\nkind = \"ball\"\na = \"w\"\nanchor_m = [0, 0, 1.0]\n";
    EXPECT_THAT(doubts(chain(40) + hook + other_end), IsEmpty()) << "the weight is held itself";
}

TEST_F(WorldDoubts, NameAModelThatStartsInTheFloor) {
    const std::string rock = std::string(kRock) + "texture = \"own.png\"\n";
    EXPECT_THAT(doubts(kFloor + rock), IsEmpty());
    // its collision hull cuts 1 cm off the sharp tip
    const std::string turned = rock + "roll_pitch_yaw_deg = [180, 0, 0]\n";
    EXPECT_THAT(doubts(kFloor + turned),
                ElementsAre(AllOf(HasSubstr("object_looks_wrong name=rock reason=\"starts 0.89 m"),
                                  HasSubstr("the place of its file's origin"))));
}

}  // namespace
}  // namespace atrium::world_server
