// `calibrate board` and `calibrate floor` with live cameras, as users start them and without a
// display.
#include "core/config/rig.hpp"
#include "tests/support/run_program.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"
#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using test_support::Outcome;
using testing::HasSubstr;

const std::string kProgram = std::string(ATRIUM_BIN_DIR) + "/calibrate ";
const std::string kRoom = " --capture.source simulated --capture.rig true.toml ";

class LiveBoards : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / fmt::format("atrium-live-boards-{}", getpid());
        fs::create_directories(folder_);
        rig_.cameras = simulation::ring(4, 640, 512);
        rig_.bounds_site = {{-1.0, -1.0, 0.1}, {1.0, 1.0, 2.1}};
        rig_.has_bounds = true;
        rig_.rate_hz = 15.0;
        ASSERT_TRUE(write_text(folder_ / "true.toml", rig_text(rig_, {}), true));
        ASSERT_EQ(run("print-board --paper a0 -o board").exit_code, 0);
    }
    void TearDown() override { fs::remove_all(folder_); }

    Outcome run(const std::string& command) const {
        return test_support::run_program(
            kProgram + command,
            240,
            "unset DISPLAY WAYLAND_DISPLAY; cd " + folder_.string() + "; ");
    }

    // The cameras are where those of the true rig are, in the frame of the site.
    void expect_the_site(const fs::path& file, double most_m) const {
        const auto made = config::load_rig(folder_ / file);
        ASSERT_TRUE(made) << made.error().message;
        ASSERT_EQ(made->cameras.size(), rig_.cameras.size());
        for (std::size_t c = 0; c < rig_.cameras.size(); ++c)
            EXPECT_LT((made->cameras[c].centre_site() - rig_.cameras[c].centre_site()).norm(),
                      most_m)
                << c;
    }

    config::Rig rig_;
    fs::path folder_;
};

TEST_F(LiveBoards, MakeARigThatABoardOnTheFloorGivesTheFrameOfTheRoom) {
    const Outcome shown = run("board" + kRoom +
                              "--simulation.shows board --board board.toml --places 16 --preview "
                              "shown/boards.png -o rig.toml");
    ASSERT_EQ(shown.exit_code, 0) << shown.output;
    EXPECT_THAT(shown.output, HasSubstr("boards: 4 cameras; show each the board near and far"));
    EXPECT_THAT(shown.output, HasSubstr("boards: 4 of 4 cameras; enough: cam0,"));
    EXPECT_THAT(shown.output, HasSubstr("wrote rig.toml"));
    EXPECT_GE(cv::imread((folder_ / "shown/boards.png").string()).cols, 640);
    const Outcome laid = run("floor rig.toml" + kRoom +
                             "--simulation.shows board --simulation.lies --board board.toml -o "
                             "room.toml");
    ASSERT_EQ(laid.exit_code, 0) << laid.output;
    EXPECT_THAT(laid.output, HasSubstr("see the board at rest: 20 of 20 instants"));
    expect_the_site("room.toml", 0.02);
}

TEST_F(LiveBoards, AWandOnTheFloorGivesTheFrameOfTheRoom) {
    // from a rig in another frame
    config::Rig moved = rig_;
    geometry::RigidTransform turn;
    turn.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
    turn.translation = {0.3, -2.0, 1.0};
    for (auto& camera : moved.cameras) camera.camera_from_site = camera.camera_from_site * turn;
    moved.has_bounds = false;
    ASSERT_TRUE(write_text(folder_ / "moved.toml", rig_text(moved, {}), true));
    const Outcome laid = run("floor moved.toml" + kRoom +
                             "--simulation.shows wand --simulation.lies --wand -o room.toml");
    ASSERT_EQ(laid.exit_code, 0) << laid.output;
    EXPECT_THAT(laid.output, HasSubstr("floor: 3 of 3 places"));
    EXPECT_THAT(laid.output, HasSubstr("look along +X, into the world; the origin is 0."));
    expect_the_site("room.toml", 0.01);
}

TEST_F(LiveBoards, SayWhatThePicturesShowInstead) {
    ASSERT_EQ(run("print-board --dictionary DICT_6X6_50 --paper a0 -o other").exit_code, 0);
    const Outcome outcome = test_support::run_program(
        "timeout --preserve-status -s INT 14 " + kProgram + "board" + kRoom +
            "--simulation.shows board --board other.toml -o rig.toml",
        120,
        "cd " + folder_.string() + "; ");
    EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("check: no picture shows a ChArUco board"));
    EXPECT_THAT(outcome.output, HasSubstr("markers of dictionary DICT_4X4_50"));
    EXPECT_FALSE(fs::exists(folder_ / "rig.toml"));
}

TEST_F(LiveBoards, NameOneSourceOfPictures) {
    EXPECT_THAT(run("board -o rig.toml").output, HasSubstr("or live cameras: --config SITE.toml"));
    EXPECT_THAT(run("board take" + kRoom + "-o rig.toml").output,
                HasSubstr("take: the pictures come from a folder or from live cameras"));
    EXPECT_THAT(run("floor true.toml --wand -o room.toml").output, HasSubstr("give one of: live"));
    EXPECT_THAT(run("floor true.toml --pictures take --wand -o room.toml").output,
                HasSubstr("--wand: goes with live cameras"));
}

}  // namespace
}  // namespace atrium::calibrate
