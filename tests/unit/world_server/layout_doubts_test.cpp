#include "tests/unit/world_server/world_doubts.hpp"

namespace atrium::world_server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(WorldDoubts, NameAWorldWithoutObjects) {
    EXPECT_THAT(all_doubts(""),
                ElementsAre(AllOf(HasSubstr("world_looks_wrong reason=\""),
                                  HasSubstr("world.toml has no objects: add [[object]] tables"))));
    EXPECT_THAT(all_doubts("[[scenery]]\nname = \"s\"\nmodel = \"rock.obj\"\n"),
                ElementsAre(HasSubstr("texture_not_drawn")));
    EXPECT_THAT(all_doubts(kFloor), IsEmpty());
}

TEST_F(WorldDoubts, NameAWorldInWhichNothingCarriesWhatFalls) {
    const auto no_floor = ElementsAre(
        HasSubstr("world_looks_wrong reason=\"nothing carries what falls: add a floor"));
    const std::string falling = box("b", 1, "position_m = [0, 0, 1]");
    EXPECT_THAT(all_doubts(falling), no_floor);
    EXPECT_THAT(all_doubts("[world]\ngravity = [0, 0, 0]\n" + falling), IsEmpty());
    EXPECT_THAT(all_doubts(falling + kFloor), IsEmpty());
    EXPECT_THAT(all_doubts(falling + box("table", 0, "position_m = [0, 0, 0.5]")), IsEmpty());
    const std::string hook = "[[joint]]\nkind = \"ball\"\na = \"b\"\nanchor_m = [0, 0, 1.2]\n";
    EXPECT_THAT(all_doubts(falling + hook), IsEmpty()) << "hangs in the world";
    const std::string other = box("c", 1, "position_m = [0.5, 0, 1]");
    EXPECT_THAT(all_doubts(falling + hook + other), no_floor);
    EXPECT_THAT(all_doubts(falling + other + hook +
                           "[[joint]]\nkind = \"ball\"\na = \"c\"\nb = \"b\"\n"
                           "anchor_m = [0.3, 0, 1]\n"),
                IsEmpty())
        << "hangs from one that hangs";
    const std::string flag =
        "[[soft]]\nname = \"flag\"\nshape = \"cloth\"\nsize_m = [1, 1]\nmass_kg = 1\n";
    EXPECT_THAT(all_doubts(flag), no_floor);
    EXPECT_THAT(all_doubts(flag + "pins = [\"top\"]\n"), IsEmpty());
    EXPECT_THAT(all_doubts(falling + "[[scenery]]\nname = \"s\"\nmodel = \"rock.obj\"\n"),
                Contains(HasSubstr("with shape = plane, or make scenery solid")));
}

TEST_F(WorldDoubts, NameTheLowestThatFallsOutOfTheWorld) {
    const std::string slab = "[[object]]\nname = \"slab\"\nshape = \"box\"\nsize_m = [6, 6, 0.1]\n";
    const std::string wall = box("wall", 0, "position_m = [5, 0, 1]");
    const std::string mug = box("mug", 1, "position_m = [1, 0, 0.3]");
    EXPECT_THAT(
        all_doubts(slab + "mass_kg = 100\n" + wall + mug),
        ElementsAre(HasSubstr("object_looks_wrong name=slab reason=\"nothing fixed is below "
                              "it, so it falls out of the world: mass_kg = 0")));
    EXPECT_THAT(all_doubts(slab + "mass_kg = 0\n" + wall + mug), IsEmpty());
    EXPECT_THAT(all_doubts(slab + "mass_kg = 100\nposition_m = [0, 0, 0.06]\n" + kFloor),
                IsEmpty());
}

TEST_F(WorldDoubts, NameASiteAtThePlaceOfAnother) {
    const auto site = [](const std::string& name, double x_m) {
        return "[[site]]\nname = \"" + name + "\"\nposition_m = [" + std::to_string(x_m) +
               ", 0, 0]\n";
    };
    EXPECT_THAT(doubts(site("a", 1) + site("b", 1.6)), IsEmpty());
    EXPECT_THAT(doubts(site("a", 1) + site("b", 1) + site("c", 3)),
                ElementsAre(HasSubstr("site_looks_wrong name=b reason=\"it is 0 m from the site "
                                      "a, so")));
}

}  // namespace
}  // namespace atrium::world_server
