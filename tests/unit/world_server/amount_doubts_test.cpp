#include "tests/unit/world_server/world_doubts.hpp"

namespace atrium::world_server {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(WorldDoubts, NameAFrictionThatNoMaterialHas) {
    EXPECT_THAT(doubts(kFloor + std::string("friction = 5\n")), IsEmpty());
    EXPECT_THAT(doubts(kFloor + std::string("friction = 8\n")),
                ElementsAre(HasSubstr("object_looks_wrong name=floor reason=\"friction = 8 is more "
                                      "than any material has")));
    const std::string flag = "[[soft]]\nname = \"flag\"\nshape = \"cloth\"\nsize_m = [1, 1]\n";
    EXPECT_THAT(doubts(flag + "mass_kg = 1\nfriction = 8\n"),
                ElementsAre(HasSubstr("soft_looks_wrong name=flag")));
}

TEST_F(WorldDoubts, NameADensityThatNoMaterialHas) {
    EXPECT_THAT(doubts(box("b", 0.2, "")), IsEmpty()) << "3.1 kg/m^3";
    EXPECT_THAT(doubts(box("b", 0.1, "")),
                ElementsAre(HasSubstr("object_looks_wrong name=b reason=\"its 0.1 kg are 1.6 "
                                      "kg/m^3 in its volume, hardly more than air")));
    EXPECT_THAT(doubts(box("b", 1500, "")), IsEmpty()) << "23400 kg/m^3";
    EXPECT_THAT(doubts(box("b", 1700, "")),
                ElementsAre(HasSubstr("kg/m^3 in its volume, more than any metal")));
    EXPECT_THAT(doubts(box("b", 0, "")), IsEmpty()) << "a fixed object has no mass";
}

TEST_F(WorldDoubts, NameAMotorThatCannotMoveItsObject) {
    const auto lift = [](const std::string& rest) {
        return box("tray", 2, "position_m = [0, 0, 1]") +
               "[[joint]]\nkind = \"slider\"\na = \"tray\"\nanchor_m = [0, 0, 1]\naxis = [0, 0, "
               "1]\n" +
               rest;
    };
    EXPECT_THAT(doubts(lift("motor_mps = 0.1\nmotor_max_n = 25\nlimits_m = [0, 1]\n")), IsEmpty());
    EXPECT_THAT(doubts(lift("motor_mps = -0.1\nmotor_max_n = 5\n")), IsEmpty()) << "down";
    EXPECT_THAT(doubts(lift("motor_mps = 0.1\nmotor_max_n = 15\n")),
                ElementsAre(HasSubstr("joint_looks_wrong a=tray b=world reason=\"its motor has 15 "
                                      "newtons, but tray alone weighs 19.6 along the axis")));
    EXPECT_THAT(doubts(lift("motor_mps = -0.1\nmotor_max_n = 25\nlimits_m = [0, 1]\n")),
                ElementsAre(HasSubstr("drives it below its lower limit of 0, where it starts")));
    const auto loaded = [&](double motor_max_n) {
        return doubts(lift("motor_mps = 0.1\nmotor_max_n = " + std::to_string(motor_max_n) + "\n") +
                      box("cargo", 3, "position_m = [0, 0, 1.4]"));
    };
    EXPECT_THAT(loaded(50), IsEmpty());
    EXPECT_THAT(loaded(40), ElementsAre(HasSubstr("tray with what rests on it weighs 49.1 along")));
}

// The hand of a clock, 0.4 m long: 2 kg with their middle 0.2 m from the axis.
TEST_F(WorldDoubts, NameAMotorThatItsWeightTurnsBack) {
    const auto hand = [](const std::string& start,
                         const std::string& axis,
                         const std::string& rest) {
        return box("hand", 2, start) +
               "[[joint]]\nkind = \"hinge\"\na = \"hand\"\nanchor_m = [0, 0, 1]\naxis = " + axis +
               "\n" + rest;
    };
    const std::string up = "position_m = [0, 0, 1.2]", aside = "position_m = [0.2, 0, 1]";
    const auto motor = [](double max_nm, double deg_per_s) {
        return "motor_deg_per_s = " + std::to_string(deg_per_s) +
               "\nmotor_max_nm = " + std::to_string(max_nm) + "\n";
    };
    const auto named = ElementsAre(HasSubstr(
        "joint_looks_wrong a=hand b=world reason=\"its motor has 3 N m, but the weight of hand "
        "alone turns it back with up to 3.92: it sticks there: give motor_max_nm that"));
    EXPECT_THAT(doubts(hand(up, "[0, 1, 0]", motor(3, 30))), named);
    EXPECT_THAT(doubts(hand(up, "[0, -0.5, 0]", motor(3, -30))), named);
    EXPECT_THAT(doubts(hand(up, "[0, 1, 0]", motor(4, 30))), IsEmpty());
    EXPECT_THAT(doubts(hand(up, "[0, 0, 1]", motor(0.1, 30))), IsEmpty()) << "a vertical axis";
    const std::string quarter = "limits_deg = [0, 90]\n";
    EXPECT_THAT(doubts(hand(up, "[0, 1, 0]", quarter + motor(3, 30))), IsEmpty()) << "falls";
    EXPECT_THAT(doubts(hand(aside, "[0, 1, 0]", quarter + motor(3, 30))), IsEmpty()) << "falls";
    EXPECT_THAT(doubts(hand(aside, "[0, -1, 0]", quarter + motor(3, 30))), named) << "rises";
    EXPECT_THAT(doubts(hand(aside, "[0, 1, 0]", "limits_deg = [-90, 0]\n" + motor(3, -30))), named);
}

TEST_F(WorldDoubts, NameASpringThatThrowsItsObject) {
    const auto spring = [](const std::string& rest) {
        return box("b", 1, "position_m = [0, 0, 1]") +
               "[[joint]]\nkind = \"spring\"\na = \"b\"\nanchor_m = [0, 0, 1.2]\n"
               "anchor_b_m = [0, 0, 2.2]\n" +
               rest;
    };
    EXPECT_THAT(doubts(spring("stiffness_npm = 1000000\n")), IsEmpty()) << "at rest";
    EXPECT_THAT(doubts(spring("stiffness_npm = 100\nrest_length_m = 0.2\n")), IsEmpty());
    EXPECT_THAT(doubts(spring("stiffness_npm = 10\nrest_length_m = 3.9\n")), IsEmpty());
    EXPECT_THAT(doubts(spring("stiffness_npm = 10\nrest_length_m = 4.1\n")),
                ElementsAre(HasSubstr("joint_looks_wrong a=b b=world reason=\"rest_length_m = 4.1, "
                                      "but its anchors are 1 m apart at the start: it pushes with "
                                      "31 newtons")));
    EXPECT_THAT(doubts(spring("stiffness_npm = 10\nrest_length_m = 4.1\npulls_only = true\n")),
                IsEmpty())
        << "a slack string";
    const std::string stiff = "stiffness_npm = 1000000\nrest_length_m = 0.5\n";
    EXPECT_THAT(doubts(spring(stiff)),
                ElementsAre(AllOf(HasSubstr("it pulls with 5e+05 newtons"),
                                  HasSubstr("which makes b up to 5e+02 m/s fast"))));
    EXPECT_THAT(doubts(spring(stiff + "force_max_n = 100\n")), IsEmpty());
    EXPECT_THAT(doubts(spring(stiff + "damping_nspm = 100000\n")), IsEmpty());
}

}  // namespace
}  // namespace atrium::world_server
