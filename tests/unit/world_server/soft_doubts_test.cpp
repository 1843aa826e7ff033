#include "tests/unit/world_server/world_doubts.hpp"

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(WorldDoubts, NameASoftObjectThatStartsInsideAFixedOne) {
    const auto cloth = [](double middle_m) {
        return "[[soft]]\nname = \"flag\"\nshape = \"cloth\"\nsize_m = [0.6, 0.6]\nmass_kg = "
               "0.2\nposition_m = [0, 0, " +
               std::to_string(middle_m) + "]\n";
    };
    EXPECT_THAT(doubts(kFloor + cloth(0.29)), IsEmpty());
    EXPECT_THAT(doubts(kFloor + cloth(0.2)),
                ElementsAre(HasSubstr("soft_looks_wrong name=flag reason=\"starts 0.10 m inside "
                                      "floor")));
    const std::string rail = box("rail", 0, "position_m = [0, 0, 1.6]");
    EXPECT_THAT(doubts(rail + cloth(1.15) + "pins = [\"top\"]\n"), IsEmpty())
        << "only its pinned edge is inside";
    EXPECT_THAT(doubts(rail + cloth(1.2)), ElementsAre(HasSubstr("inside rail")));
}

// Between the nodes of a curtain, which are 8 cm apart.
TEST_F(WorldDoubts, NameACurtainWithAPipeThroughIt) {
    const auto world = [](const char* pipe_at, const std::string& rest) {
        return "[[object]]\nname = \"pipe\"\nshape = \"box\"\nsize_m = [0.04, 0.8, 0.04]\n"
               "mass_kg = 0\nposition_m = [" +
               std::string(pipe_at) +
               "]\n[[soft]]\nname = \"curtain\"\nshape = \"cloth\"\nsize_m = [1.2, 1.6]\n"
               "spacing_m = 0.08\nmass_kg = 0.6\nposition_m = [0, 0, 1]\n" +
               rest;
    };
    const auto through = ElementsAre(
        HasSubstr("soft_looks_wrong name=curtain reason=\"starts with pipe through it"));
    // wherever it is between the nodes
    for (const char* at : {"0.1, 0, 1.1", "0.12, 0, 1.12", "0.14, 0, 1.04", "-0.22, 0.3, 0.77"})
        EXPECT_THAT(doubts(world(at, "pins = [\"top\"]\n")), through) << at;
    EXPECT_THAT(doubts(world("0.1, 0.45, 1.1", "pins = [\"top\"]\n")), IsEmpty()) << "before it";
    EXPECT_THAT(doubts(world("0, 0, 1.8", "pins = [\"top\"]\n")), IsEmpty())
        << "at its pinned edge";
    EXPECT_THAT(doubts(world("0.7, 0, 1.1", "pins = [\"top\"]\n")), IsEmpty()) << "beside it";
}

TEST_F(WorldDoubts, NameASoftObjectThatStartsInsideAMovingOne) {
    const auto ball = [](double middle_m) {
        return "[[soft]]\nname = \"soft\"\nshape = \"ball\"\ndiameter_m = 0.3\nmass_kg = 1\n"
               "position_m = [0, 0, " +
               std::to_string(middle_m) + "]\n";
    };
    const std::string crate = kFloor + box("crate", 1, "position_m = [0, 0, 0.2]");
    EXPECT_THAT(doubts(crate + ball(0.56)), IsEmpty()) << "on it";
    EXPECT_THAT(doubts(crate + ball(0.2)),
                ElementsAre(HasSubstr("soft_looks_wrong name=soft reason=\"starts 0.")));
    EXPECT_THAT(doubts(crate + ball(0.5)),
                ElementsAre(HasSubstr("inside crate, which throws both apart")));
    const std::string mat =
        "[[soft]]\nname = \"mat\"\nshape = \"box\"\nsize_m = [1.8, 1.2, 0.2]\nspacing_m = 0.1\n"
        "mass_kg = 17\nposition_m = [0, 0, 0.105]\n";
    const auto anvil_at = [&](const char* z) {
        return std::string(kFloor) +
               "[[object]]\nname = \"anvil\"\nshape = \"box\"\nsize_m = [0.4, 0.3, 0.1]\n"
               "mass_kg = 60\nposition_m = [0, 0, " +
               z + "]\n" + mat;
    };
    EXPECT_THAT(doubts(anvil_at("0.26")), IsEmpty()) << "on it";
    EXPECT_THAT(doubts(anvil_at("0.105")),
                ElementsAre(HasSubstr("soft_looks_wrong name=mat reason=\"anvil starts 0.10 m "
                                      "inside it, and may stay there")));
}

// A barrier: two posts of 10 cm, 1.4 m apart, and a rope from one to the other.
std::string barrier(double post_kg, double span_m, const std::string& ends) {
    const auto post = [&](const std::string& name, double x) {
        return "[[object]]\nname = \"" + name +
               "\"\nshape = \"cylinder\"\ndiameter_m = 0.1\nheight_m = 0.9\nmass_kg = " +
               std::to_string(post_kg) + "\nposition_m = [" + std::to_string(x) + ", 0, 0.45]\n";
    };
    return kFloor + post("post-a", -0.7) + post("post-b", 0.7) +
           "[[soft]]\nname = \"rope\"\nshape = \"rope\"\nlength_m = 1.5\nspan_m = " +
           std::to_string(span_m) +
           "\ndiameter_m = 0.03\nmass_kg = 0.4\nposition_m = [0, 0, 0.85]\n" + ends;
}

TEST_F(WorldDoubts, NamePinsInsideWhatMoves) {
    const std::string both = "pins = [\"start\", \"end\"]\n";
    EXPECT_THAT(doubts(barrier(6, 1.4, both)),
                ElementsAre(AllOf(HasSubstr("soft_looks_wrong name=rope reason=\"its pins start "
                                            "inside what can move and throw it over: start 0.05 m "
                                            "inside post-a, end 0.05 m inside post-b; "),
                                  HasSubstr("instead write tied = ['start', 'end'] and tied_to = "
                                            "['post-a', 'post-b'], or shorten span_m"))));
    EXPECT_THAT(doubts(barrier(6, 1.32, both)), ElementsAre(HasSubstr("start 0.01 m inside")));
    EXPECT_THAT(doubts(barrier(6, 1.3, both)), IsEmpty()) << "touches the posts";
    EXPECT_THAT(doubts(barrier(6, 1.26, both)), IsEmpty());
    EXPECT_THAT(doubts(barrier(0, 1.4, both)), IsEmpty()) << "fixed posts stand";
    EXPECT_THAT(doubts(barrier(6, 1.4, "pins = [\"start\"]\n")),
                ElementsAre(HasSubstr("tied = ['start'] and tied_to = 'post-a', or")));
    EXPECT_THAT(doubts(barrier(6,
                               1.4,
                               "pins = [\"end\"]\ntied = [\"start\"]\n"
                               "tied_to = \"post-a\"\n")),
                ElementsAre(HasSubstr("tied_to = ['post-b', 'post-a'], or")));
}

TEST_F(WorldDoubts, NameNothingThatIsTiedToWhatItStartsIn) {
    EXPECT_THAT(doubts(barrier(6,
                               1.4,
                               "tied = [\"start\", \"end\"]\n"
                               "tied_to = [\"post-a\", \"post-b\"]\n")),
                IsEmpty());
    EXPECT_THAT(doubts(barrier(6,
                               1.4,
                               "tied = [\"start\", \"end\"]\n"
                               "tied_to = [\"post-b\", \"post-a\"]\n")),
                ElementsAre(HasSubstr("is 1.3 m away from post-b"),
                            HasSubstr("is 1.3 m away from post-a")));
    // several of its nodes are deep in the crate
    const auto rope = [](const char* ends) {
        return kFloor + box("crate", 5, "position_m = [0, 0, 0.2]") +
               "[[soft]]\nname = \"rope\"\nshape = \"rope\"\nlength_m = 1\n"
               "diameter_m = 0.02\nmass_kg = 0.2\nposition_m = [0.5, 0, 0.3]\n" +
               std::string(ends);
    };
    EXPECT_THAT(doubts(rope("tied = [\"start\"]\ntied_to = \"crate\"\n")), IsEmpty());
    EXPECT_THAT(doubts(rope("")),
                ElementsAre(HasSubstr("inside crate, which throws both apart: move it with "
                                      "position_m, or tie it there with tied and tied_to")));
}

TEST_F(WorldDoubts, NameNoClothOnATableAndNoCushionOnASeat) {
    const std::string table =
        std::string(kFloor) +
        "[[object]]\nname = \"table\"\nshape = \"box\"\nsize_m = [1.2, 0.8, 0.7]\nmass_kg = 20\n"
        "position_m = [0, 0, 0.35]\n";
    const auto cloth = [&](const char* z, const char* pins) {
        return table +
               "[[soft]]\nname = \"cloth\"\nshape = \"cloth\"\nsize_m = [1, 0.6]\nmass_kg = 0.3\n"
               "roll_pitch_yaw_deg = [90, 0, 0]\nposition_m = [0, 0, " +
               std::string(z) + "]\n" + pins;
    };
    for (const char* pins : {"", "pins = [\"corners\"]\n"}) {
        for (const char* z : {"0.71", "0.7", "0.695"})
            EXPECT_THAT(doubts(cloth(z, pins)), IsEmpty()) << z << pins;
    }
    EXPECT_THAT(doubts(cloth("0.68", "pins = [\"corners\"]\n")),
                ElementsAre(HasSubstr("corners 0.02 m inside table; instead write tied = "
                                      "['corners'] and tied_to = 'table', or move one")));
    EXPECT_THAT(doubts(table + "[[soft]]\nname = \"cushion\"\nshape = \"box\"\n"
                               "size_m = [0.45, 0.45, 0.12]\nmass_kg = 0.4\n"
                               "position_m = [0, 0, 0.76]\n"),
                IsEmpty());
}

// As a world is saved in which a ball rests on a trampoline.
TEST_F(WorldDoubts, LetABallRestInTheDentOfACloth) {
    std::string nodes;
    for (int z = 0; z < 9; ++z) {
        for (int x = 0; x < 9; ++x) {
            const double at_x = 0.125 * (x - 4), at_y = 0.125 * (z - 4);
            const double deep_m = 0.45 * std::exp(-12.0 * (at_x * at_x + at_y * at_y));
            nodes += (nodes.empty() ? "" : ", ") + std::to_string(at_x) + ", " +
                     std::to_string(at_y) + ", " + std::to_string(1.0 - deep_m);
        }
    }
    const std::string cloth =
        "[[soft]]\nname = \"trampoline\"\nshape = \"cloth\"\nsize_m = [1.0, 1.0]\n"
        "spacing_m = 0.125\nposition_m = [0, 0, 1]\nroll_pitch_yaw_deg = [90, 0, 0]\n"
        "mass_kg = 0.5\npins = [\"corners\"]\nnodes_m = [" +
        nodes + "]\n";
    const std::string ball =
        "[[object]]\nname = \"ball\"\nshape = \"sphere\"\ndiameter_m = 0.2\nmass_kg = 1\n"
        "position_m = [0, 0, 0.67]\n";
    EXPECT_THAT(doubts(kFloor + cloth + ball), IsEmpty());
}

TEST_F(WorldDoubts, NameATieFarFromItsObject) {
    const auto rope = [](double end_m) {
        return kFloor + box("b", 1, "position_m = [0, 0, 1]") +
               "[[soft]]\nname = \"rope\"\nshape = \"rope\"\nlength_m = 1\ndiameter_m = 0.02\n"
               "mass_kg = 1\npins = [\"start\"]\ntied = [\"end\"]\ntied_to = \"b\"\n"
               "position_m = [" +
               std::to_string(end_m - 0.5) + ", 0, 1]\n";
    };
    EXPECT_THAT(doubts(rope(-0.2)), IsEmpty());
    EXPECT_THAT(doubts(rope(-0.28)), IsEmpty()) << "0.08 m away";
    EXPECT_THAT(doubts(rope(-0.4)), ElementsAre(HasSubstr("is 0.2 m away from b;")));
    EXPECT_THAT(doubts(rope(-3.2)),
                ElementsAre(HasSubstr("soft_looks_wrong name=rope reason=\"tied at [-3.20, 0.00, "
                                      "1.00] is 3 m away from b;")));
}

TEST_F(WorldDoubts, NameATiedEdgeFarFromItsObject) {
    const auto flag = [](const std::string& place, const std::string& edge) {
        return std::string(kFloor) +
               "[[object]]\nname = \"mast\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 3]\n"
               "mass_kg = 9\nposition_m = [0, 0, 1.51]\n"
               "[[soft]]\nname = \"flag\"\nshape = \"cloth\"\nsize_m = [0.8, 0.4]\n"
               "mass_kg = 0.1\ntied = [\"" +
               edge + "\"]\ntied_to = \"mast\"\nposition_m = [" + place + "]\n";
    };
    EXPECT_THAT(doubts(flag("0.46, 0, 2", "left")), IsEmpty());
    EXPECT_THAT(doubts(flag("-0.46, 0, 2", "right")), IsEmpty());
    EXPECT_THAT(doubts(flag("0, 0, 3.21", "bottom")), IsEmpty());
    EXPECT_THAT(doubts(flag("2.95, 0, 2", "left")),
                ElementsAre(HasSubstr("tied at [2.55, 0.00, ")));
    EXPECT_THAT(doubts(flag("2.95, 0, 2", "left")),
                ElementsAre(HasSubstr("is 2.5 m away from mast")));
}

}  // namespace
}  // namespace atrium::world_server
