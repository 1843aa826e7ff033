#include "tests/unit/world_server/world_doubts.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

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

// A box from one corner to the other.
struct Panel {
    std::array<double, 3> from, to;
};

std::string panels_obj(const std::vector<Panel>& panels) {
    std::string text;
    int first = 1;
    for (const auto& [from, to] : panels) {
        text += fmt::format("o panel{}\n", first);
        for (const double x : {from[0], to[0]})
            for (const double y : {from[1], to[1]})
                for (const double z : {from[2], to[2]})
                    text += fmt::format("v {} {} {}\n", x, y, z);
        for (const auto& f : {std::array{0, 1, 3, 2},
                              {4, 6, 7, 5},
                              {0, 4, 5, 1},
                              {2, 3, 7, 6},
                              {0, 2, 6, 4},
                              {1, 5, 7, 3}})
            text += fmt::format(
                "f {} {} {} {}\n", first + f[0], first + f[1], first + f[2], first + f[3]);
        first += 8;
    }
    return text;
}

// Open towards -y: 0.6 m wide, 0.5 m deep, 0.3 m high, of boards of 2 cm.
std::string carcass_obj() {
    return panels_obj({{{-0.3, -0.25, 0}, {-0.28, 0.25, 0.3}},
                       {{0.28, -0.25, 0}, {0.3, 0.25, 0.3}},
                       {{-0.28, -0.25, 0}, {0.28, 0.25, 0.02}},
                       {{-0.28, -0.25, 0.28}, {0.28, 0.25, 0.3}},
                       {{-0.28, 0.23, 0.02}, {0.28, 0.25, 0.28}}});
}

// Of boards of `thick_m`, with `gap_m` of air behind it and `side_m` around it.
std::string drawer_obj(double thick_m, double gap_m, double side_m) {
    const double x = 0.28 - side_m, front = -0.25, back = 0.23 - gap_m, low = 0.02 + side_m;
    const double high = 0.2, t = thick_m;
    return panels_obj({{{-x, front, low}, {x, back, low + t}},
                       {{-x, front, low + t}, {-x + t, back, high}},
                       {{x - t, front, low + t}, {x, back, high}},
                       {{-x + t, front, low + t}, {x - t, front + t, high}},
                       {{-x + t, back - t, low + t}, {x - t, back, high}}});
}

std::string drawer(double carcass_kg, const std::string& joint) {
    return std::string(kFloor) +
           "[[object]]\nname = \"carcass\"\nshape = \"compound\"\nmodel = \"carcass.obj\"\n"
           "position_m = [0, 0, 0.001]\nmass_kg = " +
           std::to_string(carcass_kg) +
           "\n[[object]]\nname = \"drawer\"\nshape = \"compound\"\nmodel = \"drawer.obj\"\n"
           "position_m = [0, 0, 0.001]\nmass_kg = 3\n"
           "[[joint]]\nkind = \"slider\"\nanchor_m = [0, 0, 0.1]\n" +
           joint;
}

constexpr const char* kInCarcass = "a = \"drawer\"\nb = \"carcass\"\n";
constexpr const char* kOut = "axis = [0, -1, 0]\nlimits_m = [0, 0.28]\n";
constexpr const char* kIn = "axis = [0, 1, 0]\nlimits_m = [0, 0.28]\n";

TEST_F(WorldDoubts, NameADrawerThatOpensIntoItsCarcass) {
    put("carcass.obj", carcass_obj());
    for (const double thick_m : {0.006, 0.02}) {
        for (const double side_m : {0.002, 0.01}) {
            for (const double carcass_kg : {0.0, 20.0}) {
                put("drawer.obj", drawer_obj(thick_m, 0.03, side_m));
                const std::string in = kInCarcass;
                EXPECT_THAT(doubts(drawer(carcass_kg, in + kOut)), IsEmpty());
                EXPECT_THAT(
                    doubts(drawer(carcass_kg, in + "axis = [0, 1, 0]\nlimits_m = [-0.28, 0]\n")),
                    IsEmpty());
                const auto named = ElementsAre(
                    AllOf(HasSubstr("joint_looks_wrong a=drawer b=carcass reason=\"from "),
                          HasSubstr("0.04 m on drawer goes through carcass, and the other way it "
                                    "is free: reverse axis, or")));
                EXPECT_THAT(doubts(drawer(carcass_kg, in + kIn)), named) << thick_m << side_m;
                EXPECT_THAT(doubts(drawer(carcass_kg,
                                          in + "axis = [0, -1, 0]\nlimits_m = [-0.28, 0.005]\n")),
                            named)
                    << thick_m << side_m;
            }
        }
    }
    // the other way round, and so the sign of the motion
    const std::string swapped = "a = \"carcass\"\nb = \"drawer\"\n";
    EXPECT_THAT(doubts(drawer(0, swapped + kIn)), IsEmpty());
    EXPECT_THAT(doubts(drawer(0, swapped + kOut)),
                ElementsAre(AllOf(HasSubstr("joint_looks_wrong a=carcass b=drawer"),
                                  HasSubstr("from 0.04 m on drawer goes through carcass"))));
}

TEST_F(WorldDoubts, NameADrawerThatItsCarcassStopsEarly) {
    put("carcass.obj", carcass_obj());
    for (const double gap_m : {0.005, 0.05}) {
        put("drawer.obj", drawer_obj(0.02, gap_m, 0.01));
        for (const std::string joined :
             {"a = \"drawer\"\n", "a = \"drawer\"\nb = \"carcass\"\ncollide = true\n"}) {
            EXPECT_THAT(doubts(drawer(0, joined + kOut)), IsEmpty()) << gap_m << joined;
            EXPECT_THAT(doubts(drawer(0, joined + kIn)),
                        ElementsAre(AllOf(HasSubstr("joint_looks_wrong a=drawer b="),
                                          HasSubstr("because carcass stops it; the other way it "
                                                    "is free: reverse axis"))))
                << gap_m << joined;
        }
    }
    put("drawer.obj", drawer_obj(0.02, 0.1, 0.01));
    EXPECT_THAT(doubts(drawer(0, std::string("a = \"drawer\"\n") + kIn)), IsEmpty())
        << "has more than a quarter of its way";
}

TEST_F(WorldDoubts, NameNoSliderThatMayGoIntoSomething) {
    put("carcass.obj", carcass_obj());
    put("drawer.obj", drawer_obj(0.02, 0.03, -0.008));
    const std::string in = kInCarcass;
    EXPECT_THAT(doubts(drawer(0, in + kOut)), IsEmpty()) << "overlaps the boards by 8 mm";
    put("drawer.obj", drawer_obj(0.02, 0.03, 0.01));
    EXPECT_THAT(doubts(drawer(0, in + "axis = [0, 1, 0]\n")), IsEmpty()) << "no limits";
    EXPECT_THAT(doubts(drawer(0, in + "axis = [0, 1, 0]\nlimits_m = [-0.2, 0.2]\n")), IsEmpty());
    EXPECT_THAT(doubts(drawer(0, in + "axis = [0, 1, 0]\nlimits_m = [0, 0.03]\n")), IsEmpty());
    EXPECT_THAT(doubts(drawer(0, in + "axis = [1, 0, 0]\nlimits_m = [0, 0.3]\n")), IsEmpty())
        << "in both directions";
    // `moving` stands at x and goes 0.3 m further
    const auto slider = [](const std::string& x, const char* rest) {
        return std::string(kFloor) + box("post", 0, "position_m = [0, 0, 0.3]") +
               box("moving", 5, "position_m = [" + x + ", 0, 0.3]") +
               "[[joint]]\nkind = \"slider\"\na = \"moving\"\nanchor_m = [0, 0, 0.3]\n" + rest;
    };
    EXPECT_THAT(doubts(slider("-0.45", "b = \"post\"\naxis = [1, 0, 0]\nlimits_m = [0, 0.3]\n")),
                IsEmpty())
        << "a telescope that is pushed together";
    EXPECT_THAT(doubts(slider("-0.6", "axis = [1, 0, 0]\nlimits_m = [0, 1]\n")), IsEmpty())
        << "a trolley that a buffer stops";
}

}  // namespace
}  // namespace atrium::world_server
