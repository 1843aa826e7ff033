#include "tests/unit/world_server/world_doubts.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

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

TEST_F(WorldDoubts, SayThatAPlaneHasNoEnd) {
    const std::string poster =
        "[[object]]\nname = \"poster\"\nshape = \"plane\"\nsize_m = [1, 0.7]\n"
        "position_m = [0, 0, 1.5]\nroll_pitch_yaw_deg = [0, 90, 0]\n";
    EXPECT_THAT(doubts(poster + box("b", 1, "position_m = [-1, 0, 0.3]")),
                ElementsAre(AllOf(HasSubstr("inside poster, a plane, which has no end"),
                                  HasSubstr("is a thin box"))));
    EXPECT_THAT(doubts(poster + box("b", 1, "position_m = [-1, 0, 1.5]")),
                ElementsAre(HasSubstr("inside poster, which is fixed")));
    EXPECT_THAT(doubts(poster + box("b", 1, "position_m = [1, 0, 0.3]")), IsEmpty());
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

TEST_F(WorldDoubts, NameAGltfModelThatWasTurnedUpright) {
    put("tent.gltf", tetrahedron_gltf("", "", ""));
    const std::string tent =
        std::string(kFloor) +
        "[[object]]\nname = \"tent\"\nshape = \"convex\"\nmodel = \"tent.gltf\"\nmass_kg = 5\n";
    EXPECT_THAT(doubts(tent), IsEmpty());
    EXPECT_THAT(doubts(tent + "roll_pitch_yaw_deg = [90, 0, 0]\n"),
                ElementsAre(AllOf(HasSubstr("starts 0.89 m inside floor"),
                                  HasSubstr("glTF stands upright as it is: then remove "
                                            "roll_pitch_yaw_deg; else move it"))));
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

TEST_F(WorldDoubts, NameAHeavyLidOnALightBox) {
    const auto chest = [](double box_kg, double lid_kg) {
        return kFloor + box("chest", box_kg, "position_m = [0, 0, 0.2]") +
               box("lid", lid_kg, "position_m = [0, 0, 0.62]") +
               "[[joint]]\nkind = \"hinge\"\na = \"lid\"\nb = \"chest\"\n"
               "anchor_m = [0, 0.2, 0.41]\naxis = [1, 0, 0]\n";
    };
    EXPECT_THAT(doubts(chest(1, 60)), IsEmpty());
    EXPECT_THAT(doubts(chest(60, 0.5)), IsEmpty()) << "light on heavy";
    EXPECT_THAT(doubts(chest(0.5, 80)),
                ElementsAre(HasSubstr("object_looks_wrong name=chest reason=\"its 0.5 kg carry 80 "
                                      "kg, 160 times as much; the heaviest is lid with 80 kg: "
                                      "their joint tears above 100 times")));
    const auto both = doubts(box("stone", 1, "position_m = [0, 0, 0.2]") + chest(0.5, 80));
    EXPECT_THAT(both,
                testing::Contains(HasSubstr("name=chest reason=\"starts 0.40 m inside stone")));
    EXPECT_THAT(both, testing::Contains(HasSubstr("their joint tears")));
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

// A square bucket of 0.4 m, open above, with walls of 2 cm, as one closed mesh; or its five walls
// as parts.
std::string bucket_obj(bool is_split, bool faces_inwards = false) {
    std::string text;
    std::size_t num_vertices = 0;
    const auto add_vertices = [&](const std::vector<std::array<double, 3>>& corners) {
        for (const auto& c : corners) text += fmt::format("v {} {} {}\n", c[0], c[1], c[2]);
        num_vertices += corners.size();
    };
    const auto add_face = [&](std::array<std::size_t, 4> f, std::size_t first) {
        if (faces_inwards) std::swap(f[1], f[3]);
        text +=
            fmt::format("f {} {} {} {}\n", first + f[0], first + f[1], first + f[2], first + f[3]);
    };
    if (is_split) {
        const std::array<std::array<double, 6>, 5> walls{{{-0.2, -0.2, 0.0, 0.2, 0.2, 0.02},
                                                          {-0.2, -0.2, 0.02, -0.18, 0.2, 0.4},
                                                          {0.18, -0.2, 0.02, 0.2, 0.2, 0.4},
                                                          {-0.18, -0.2, 0.02, 0.18, -0.18, 0.4},
                                                          {-0.18, 0.18, 0.02, 0.18, 0.2, 0.4}}};
        for (std::size_t w = 0; w < walls.size(); ++w) {
            text += fmt::format("o wall{}\n", w);
            const std::size_t first = num_vertices + 1;
            std::vector<std::array<double, 3>> corners;
            for (std::size_t i = 0; i < 8; ++i)
                corners.push_back({walls[w][(i & 1U) != 0 ? 3 : 0],
                                   walls[w][(i & 2U) != 0 ? 4 : 1],
                                   walls[w][(i & 4U) != 0 ? 5 : 2]});
            add_vertices(corners);
            for (const auto& face : std::vector<std::array<std::size_t, 4>>{{0, 2, 3, 1},
                                                                            {4, 5, 7, 6},
                                                                            {0, 1, 5, 4},
                                                                            {2, 6, 7, 3},
                                                                            {0, 4, 6, 2},
                                                                            {1, 3, 7, 5}})
                add_face(face, first);
        }
        return text;
    }
    const auto ring = [&](double half_m, double z_m) {
        add_vertices({{-half_m, -half_m, z_m},
                      {half_m, -half_m, z_m},
                      {half_m, half_m, z_m},
                      {-half_m, half_m, z_m}});
    };
    ring(0.2, 0.0);
    ring(0.2, 0.4);
    ring(0.18, 0.4);
    ring(0.18, 0.02);
    add_face({3, 2, 1, 0}, 1);
    for (std::size_t level = 0; level < 3; ++level) {
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t next = (i + 1) % 4;
            add_face({i, next, 4 + next, 4 + i}, 1 + 4 * level);
        }
    }
    add_face({0, 1, 2, 3}, 13);
    return text;
}

TEST_F(WorldDoubts, NameTheHollowThatThePhysicsFills) {
    const auto bucket = [](const std::string& shape) {
        return "[[object]]\nname = \"bucket\"\nshape = \"" + shape +
               "\"\nmodel = \"bucket.obj\"\nmass_kg = 1\nposition_m = [1, 0, 1]\n"
               "roll_pitch_yaw_deg = [0, 0, 30]\n";
    };
    const std::string apple =
        "[[object]]\nname = \"apple\"\nshape = \"sphere\"\ndiameter_m = 0.1\nmass_kg = 0.1\n"
        "position_m = [1, 0, ";
    const auto cause = HasSubstr(
        "the physics fills the hollow of bucket: split it into parts (`o` lines of an OBJ, meshes "
        "of a GLB) with shape = 'compound'");
    for (const bool faces_inwards : {false, true}) {
        put("bucket.obj", bucket_obj(false, faces_inwards));
        for (const char* shape : {"convex", "compound"}) {
            EXPECT_THAT(doubts(bucket(shape) + apple + "1.07]\n"),
                        ElementsAre(AllOf(HasSubstr("name=apple reason=\"starts"),
                                          HasSubstr("inside bucket"),
                                          cause,
                                          HasSubstr(", or move it with position_m"))))
                << "once, although the compound has one part";
        }
        EXPECT_THAT(doubts(bucket("compound") + apple + "1.6]\n"),
                    ElementsAre(AllOf(HasSubstr("name=bucket model=bucket.obj reason=\"its file "
                                                "has one part, whose surface encloses 23 % of its "
                                                "convex hull"),
                                      cause)));
        EXPECT_THAT(doubts(bucket("convex") + apple + "1.6]\n"), IsEmpty())
            << "a convex shape is said to be one hull";
    }
    const std::string cloth =
        "[[soft]]\nname = \"ball\"\nshape = \"ball\"\ndiameter_m = 0.2\nmass_kg = 0.2\n"
        "position_m = [1, 0, 1.2]\n";
    EXPECT_THAT(doubts(bucket("convex") + cloth),
                ElementsAre(AllOf(HasSubstr("soft_looks_wrong name=ball"), cause)));
    put("bucket.obj", bucket_obj(true));
    EXPECT_THAT(doubts(bucket("compound") + apple + "1.07]\n"), IsEmpty());
    // as turned shapes have on their axis
    std::string pinhole = bucket_obj(false);
    pinhole.erase(pinhole.rfind("f "));
    pinhole +=
        "v -0.001 -0.001 0.02\nv 0.001 -0.001 0.02\nv 0.001 0.001 0.02\nv -0.001 0.001 0.02\n"
        "f 13 14 18 17\nf 14 15 19 18\nf 15 16 20 19\nf 16 13 17 20\n";
    put("bucket.obj", pinhole);
    EXPECT_THAT(doubts(bucket("convex") + apple + "1.07]\n"), ElementsAre(cause));
}

TEST_F(WorldDoubts, BlameNoHollowForWhatStartsInSomethingSolid) {
    put("rock.obj",
        "v 0 0 0\nv 0.9 0 0\nv 0 0.9 0\nv 0 0 0.9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const std::string rock =
        "[[object]]\nname = \"rock\"\nshape = \"compound\"\nmodel = \"rock.obj\"\nmass_kg = 50\n";
    EXPECT_THAT(doubts(rock + box("b", 1, "position_m = [0.2, 0.2, 0.2]")),
                ElementsAre(AllOf(HasSubstr("inside rock"), Not(HasSubstr("hollow")))));
    // a bucket whose bottom is missing encloses nothing
    std::string open = bucket_obj(false);
    open.erase(open.find("f "), open.find('\n', open.find("f ")) + 1 - open.find("f "));
    put("rock.obj", open);
    EXPECT_THAT(doubts(rock + box("b", 1, "position_m = [2, 0, 0]")), IsEmpty());
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
