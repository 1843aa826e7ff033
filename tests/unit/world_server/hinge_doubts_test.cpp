#include "tests/unit/world_server/world_doubts.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A lid on a chest, with its hinge along the upper edge at the back.
std::string chest(const std::string& rest) {
    return std::string(kFloor) +
           "[[object]]\nname = \"chest\"\nshape = \"box\"\nsize_m = [0.6, 0.4, 0.4]\nmass_kg = 9\n"
           "position_m = [0, 0, 0.2]\n"
           "[[object]]\nname = \"lid\"\nshape = \"box\"\nsize_m = [0.6, 0.4, 0.04]\nmass_kg = 1\n"
           "position_m = [0, 0, 0.42]\n"
           "[[joint]]\nkind = \"hinge\"\na = \"lid\"\nb = \"chest\"\nanchor_m = [0, 0.2, 0.4]\n" +
           rest;
}

TEST_F(WorldDoubts, NameAHingeThatOpensIntoItsOtherObject) {
    EXPECT_THAT(doubts(chest("axis = [-1, 0, 0]\nlimits_deg = [0, 110]\n")), IsEmpty());
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\nlimits_deg = [-110, 0]\n")), IsEmpty());
    const auto named = ElementsAre(HasSubstr("joint_looks_wrong a=lid b=chest reason=\"at "));
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\nlimits_deg = [0, 110]\n")), named);
    EXPECT_THAT(doubts(chest("axis = [-1, 0, 0]\nlimits_deg = [-110, 2]\n")), named);
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\nlimits_deg = [0, 110]\n")),
                ElementsAre(HasSubstr("inside chest, and the other way it is free: reverse axis")));
}

TEST_F(WorldDoubts, NameNoHingeThatMayPassThrough) {
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\nlimits_deg = [-60, 60]\n")), IsEmpty());
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\n")), IsEmpty()) << "a wheel turns freely";
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\nlimits_deg = [0, 10]\n")), IsEmpty());
    EXPECT_THAT(doubts(chest("axis = [0, 0, 1]\nlimits_deg = [0, 90]\n")), IsEmpty())
        << "slides over the chest";
}

// Walls of 12 cm beside an opening from -`air_m` to 0.8 m + `air_m`, as scenery.
std::string walls_obj(double air_m) {
    std::string text;
    int first = 1;
    for (const auto& [from_m, to_m] : {std::pair{-0.5, -air_m}, {0.8 + air_m, 1.3}}) {
        for (const double x : {from_m, to_m})
            for (const double y : {-0.06, 0.06})
                for (const double z : {0.0, 2.2}) text += fmt::format("v {} {} {}\n", x, y, z);
        for (const auto& f : {std::array{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}})
            text += fmt::format(
                "f {} {} {} {}\n", first + f[0], first + f[1], first + f[2], first + f[3]);
        first += 8;
    }
    return text;
}

// A door of 4 cm between them, with its hinge in the middle of its left edge, at x = 0.
std::string door(const std::string& more) {
    return std::string(kFloor) +
           "[[scenery]]\nname = \"walls\"\nmodel = \"walls.obj\"\nsolid = true\n"
           "[[object]]\nname = \"door\"\nshape = \"box\"\nsize_m = [0.8, 0.04, 2.0]\n"
           "mass_kg = 12\nposition_m = [0.4, 0, 1.02]\n"
           "[[joint]]\nkind = \"hinge\"\na = \"door\"\nanchor_m = [0, 0, 1]\naxis = [0, 0, 1]\n" +
           more;
}

TEST_F(WorldDoubts, NameADoorThatItsOpeningStops) {
    for (const char* limits : {"limits_deg = [-5, 110]\n", "limits_deg = [-110, 0]\n", ""}) {
        put("walls.obj", walls_obj(0.03));
        EXPECT_THAT(doubts(door(limits)), IsEmpty()) << limits;
        EXPECT_THAT(doubts(door(std::string(limits) + "damping_nms = 50\n")), IsEmpty())
            << "a stiff hinge";
        put("walls.obj", walls_obj(0.0));
        EXPECT_THAT(doubts(door(limits)),
                    ElementsAre(AllOf(HasSubstr("joint_looks_wrong a=door b=world"),
                                      HasSubstr("because walls stops it; leave 1 cm of air"))))
            << limits;
    }
}

TEST_F(WorldDoubts, NameALidThatItsChestStops) {
    const std::string collides = "collide = true\n";
    EXPECT_THAT(doubts(chest("axis = [-1, 0, 0]\nlimits_deg = [0, 110]\n" + collides)), IsEmpty());
    EXPECT_THAT(
        doubts(chest("axis = [1, 0, 0]\nlimits_deg = [0, 110]\n" + collides)),
        ElementsAre(HasSubstr("because chest stops it; the other way it is free: reverse")));
}

TEST_F(WorldDoubts, NameADrawerThatIsStuckAndNoneThatSlides) {
    const auto drawer = [](double width_m, double front_m) {
        return std::string(kFloor) + box("left", 0.0, "position_m = [-0.4, 0, 0.5]") +
               box("right", 0.0, "position_m = [0.4, 0, 0.5]") +
               "[[object]]\nname = \"drawer\"\nshape = \"box\"\nsize_m = [" +
               std::to_string(width_m) + ", 0.4, 0.1]\nmass_kg = 2\nposition_m = [0, 0, 0.5]\n" +
               box("bench", 0.0, "position_m = [0, " + std::to_string(-0.4 - front_m) + ", 0.5]") +
               "[[joint]]\nkind = \"slider\"\na = \"drawer\"\nanchor_m = [0, 0, 0.5]\n"
               "axis = [0, -1, 0]\nlimits_m = [0, 0.35]\n";
    };
    EXPECT_THAT(doubts(drawer(0.38, 0.4)), IsEmpty());
    EXPECT_THAT(doubts(drawer(0.38, 0.01)),
                ElementsAre(AllOf(HasSubstr("drawer moves by 0.0"), HasSubstr("bench stops it"))));
}

}  // namespace
}  // namespace atrium::world_server
