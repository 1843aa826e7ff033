#include "tests/unit/world_server/world_doubts.hpp"

namespace atrium::world_server {
namespace {

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
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\nlimits_deg = [0, 110]\ncollide = true\n")),
                IsEmpty())
        << "the chest stops the lid";
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\nlimits_deg = [-60, 60]\n")), IsEmpty());
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\n")), IsEmpty()) << "a wheel turns freely";
    EXPECT_THAT(doubts(chest("axis = [1, 0, 0]\nlimits_deg = [0, 10]\n")), IsEmpty());
    EXPECT_THAT(doubts(chest("axis = [0, 0, 1]\nlimits_deg = [0, 90]\n")), IsEmpty())
        << "slides over the chest";
}

}  // namespace
}  // namespace atrium::world_server
