#include "core/config/spelling.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace atrium::config {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const std::vector<std::string> kKeys{"view.width",
                                     "video.width",
                                     "view.height",
                                     "simulation.motion",
                                     "capture.rate_hz",
                                     "bus.world",
                                     "startup-seconds"};

TEST(Spelling, FindsTheNameThatIsMeant) {
    EXPECT_THAT(names_meant_by("simulation.moton", kKeys), ElementsAre("simulation.motion"));
    EXPECT_THAT(names_meant_by("simulaton.motion", kKeys), ElementsAre("simulation.motion"));
    EXPECT_THAT(names_meant_by("elephant", kKeys), IsEmpty());
}

TEST(Spelling, FindsNamesWithoutTheirTableOrInAnother) {
    EXPECT_THAT(names_meant_by("widht", kKeys), ElementsAre("view.width", "video.width"));
    EXPECT_THAT(names_meant_by("site.motion", kKeys), ElementsAre("simulation.motion"));
    // a name in the same table goes first
    EXPECT_THAT(names_meant_by("view.widht", kKeys), ElementsAre("view.width"));
}

TEST(Spelling, DoesNotTakeAShortNameForAnotherWord) {
    const std::vector<std::string> keys{"display.tile", "process.nice", "video.file", "a.speed"};
    EXPECT_THAT(names_meant_by("view.size", keys), IsEmpty());
    EXPECT_THAT(names_meant_by("view.fil", keys), ElementsAre("video.file"));
}

TEST(Spelling, TakesASizeForWidthAndHeight) {
    EXPECT_THAT(names_meant_by("view.size", {"view.height", "view.width", "video.width"}),
                ElementsAre("view.width", "view.height"));
}

TEST(Spelling, FindsNamesWithoutTheirUnit) {
    EXPECT_THAT(names_meant_by("capture.rate", kKeys), ElementsAre("capture.rate_hz"));
    EXPECT_EQ(must_be_one_of({"wood", "stone"}, "wod"),
              "must be one of wood, stone (did you mean wood?)");
    EXPECT_EQ(must_be_one_of({"wood", "stone"}, "air"), "must be one of wood, stone");
    EXPECT_THAT(names_meant_by("capture.rate_fps", kKeys), ElementsAre("capture.rate_hz"));
    EXPECT_THAT(names_meant_by("limits_rad", {"limits_deg", "limits_m"}),
                ElementsAre("limits_deg", "limits_m"));
    EXPECT_THAT(names_meant_by("limits_low", {"limits_deg"}), IsEmpty());
    EXPECT_THAT(names_meant_by("rate", kKeys), ElementsAre("capture.rate_hz"));
}

TEST(Spelling, FindsNamesByTheirLastWords) {
    const std::vector<std::string> keys{"soft.roll_pitch_yaw_deg", "soft.position_m"};
    EXPECT_THAT(names_meant_by("soft.yaw_deg", keys), ElementsAre("soft.roll_pitch_yaw_deg"));
    EXPECT_THAT(names_meant_by("soft.w_deg", keys), IsEmpty()) << "no whole word";
}

TEST(Spelling, GuessesOnlyWhatIsNearInSpelling) {
    EXPECT_THAT(names_meant_by("light", {"rights", "soft"}), IsEmpty());
    EXPECT_THAT(names_meant_by("right", {"rights", "soft"}), ElementsAre("rights"));
    EXPECT_THAT(names_meant_by("mdoel", {"model"}), ElementsAre("model"));
    EXPECT_THAT(names_meant_by("objekts", {"object"}), ElementsAre("object"));
    EXPECT_THAT(names_meant_by("textrue", {"texture"}), ElementsAre("texture"));
}

TEST(Spelling, TakesDashesForUnderscores) {
    EXPECT_THAT(names_meant_by("startup_seconds", kKeys), ElementsAre("startup-seconds"));
    EXPECT_THAT(names_meant_by("capture.rate-hz", kKeys), ElementsAre("capture.rate_hz"));
}

TEST(Spelling, AsksWhichNameIsMeant) {
    EXPECT_EQ(ask_which({}), "");
    EXPECT_EQ(ask_which({"a"}), "did you mean a?");
    EXPECT_EQ(ask_which({"a", "b"}, "--"), "did you mean --a or --b?");
}

TEST(Spelling, AsksForTheFolderOrFileThatAPathMeans) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::path(testing::TempDir()) / "spelling_of_paths";
    fs::create_directories(folder / "meshes");
    std::ofstream(folder / "meshes" / "Chair.OBJ") << "v 0 0 0\n";
    const std::string at = folder.string();
    EXPECT_EQ(ask_which_path(folder / "mehses" / "hull.ply"), "did you mean " + at + "/meshes?");
    EXPECT_EQ(ask_which_path(folder / "meshes" / "chair.obj"),
              "did you mean " + at + "/meshes/Chair.OBJ?");
    EXPECT_EQ(ask_which_path(folder / "elsewhere" / "hull.ply"), "");
    EXPECT_EQ(ask_which_path(folder / "meshes" / "Chair.OBJ"), "") << "it exists";
    EXPECT_EQ(ask_which_path(folder / "meshes" / "chair"),
              "did you mean " + at + "/meshes/Chair.OBJ?");
    EXPECT_EQ(ask_which_path({}), "");
    fs::remove_all(folder);
}

}  // namespace
}  // namespace atrium::config
