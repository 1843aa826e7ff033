// `calibrate wand` from pictures to a rig, as users start it and without a display.
#include "core/config/rig.hpp"
#include "simulation/wand_room.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/skips.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"
#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using test_support::Outcome;
using testing::HasSubstr;

const std::string kCalibrate = std::string(ATRIUM_BIN_DIR) + "/calibrate wand ";

class SweepProgram : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / fmt::format("atrium-sweep-{}", getpid());
        fs::create_directories(folder_);
        rig_.cameras = simulation::ring(4, 640, 512);
        rig_.bounds_site = {{-1.0, -1.0, 0.1}, {1.0, 1.0, 2.1}};
        rig_.has_bounds = true;
        rig_.rate_hz = 20.0;
        ASSERT_TRUE(write_text(folder_ / "true.toml", rig_text(rig_, {}), true));
    }
    void TearDown() override { fs::remove_all(folder_); }

    // Without a display, in the folder of the test.
    Outcome run(const std::string& command) const {
        return test_support::run_program(
            command, 240, "unset DISPLAY WAYLAND_DISPLAY; cd " + folder_.string() + "; ");
    }

    // The distances of all cameras are those of the true rig.
    void expect_the_rig(const fs::path& file) const {
        const auto made = config::load_rig(folder_ / file);
        ASSERT_TRUE(made) << made.error().message;
        ASSERT_EQ(made->cameras.size(), rig_.cameras.size());
        for (std::size_t a = 0; a < rig_.cameras.size(); ++a) {
            EXPECT_EQ(made->cameras[a].intrinsics.width, 640);
            for (std::size_t b = 0; b < a; ++b) {
                const auto apart = [&](const config::Rig& rig) {
                    return (rig.cameras[a].centre_site() - rig.cameras[b].centre_site()).norm();
                };
                EXPECT_NEAR(apart(*made), apart(rig_), 0.02) << a << " " << b;
            }
        }
    }

    config::Rig rig_;
    fs::path folder_;
};

const std::string kSimulated =
    "--capture.source simulated --capture.rig true.toml --simulation.shows wand ";

TEST_F(SweepProgram, MakesARigOfASimulatedSweep) {
    const Outcome outcome =
        run(kCalibrate + kSimulated + "--instants 80 --preview shown/sweep.png -o rig.toml");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("sweep: 4 cameras"));
    EXPECT_THAT(outcome.output, HasSubstr("sweep: 80 of 80 instants; enough: cam0,"));
    EXPECT_THAT(outcome.output, HasSubstr("--points rig.points.csv --size 640x512"));
    EXPECT_THAT(outcome.output, HasSubstr("wrote rig.toml"));
    expect_the_rig("rig.toml");
    const cv::Mat preview = cv::imread((folder_ / "shown/sweep.png").string());
    EXPECT_GE(preview.cols, 640);
    const Outcome again =
        run(kCalibrate + "--points rig.points.csv --size 640x512 --rate 20 -o again.toml");
    EXPECT_EQ(again.exit_code, 0) << again.output;
    expect_the_rig("again.toml");
}

TEST_F(SweepProgram, SolvesWithWhatWasSeenAtCtrlC) {
    // a sweep that never is enough
    const Outcome outcome = run("timeout --preserve-status -s INT 12 " + kCalibrate + kSimulated +
                                "--instants 100000 --keep-points kept.csv -o rig.toml");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("of 100000 instants; cam")) << "every five seconds";
    EXPECT_THAT(outcome.output, HasSubstr("wrote kept.csv"));
    expect_the_rig("rig.toml");
}

// Of cameras that were never calibrated there is no rig.toml.
TEST_F(SweepProgram, ReadsARecordingWithoutARig) {
    const simulation::WandRoom room(rig_, {.noise_lsb = 0.6});
    image::Plane plane;
    constexpr int kInstants = 90;
    for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
        const fs::path frames = folder_ / "take" / rig_.cameras[c].name / "frames";
        fs::create_directories(frames);
        for (int i = 0; i < kInstants; ++i) {
            if (c == 1 && i == 40) continue;  // a lost picture
            room.render(i / 10.0, c, plane);
            const cv::Mat grey(plane.height, plane.width, CV_8UC1, plane.data.data());
            ASSERT_TRUE(cv::imwrite((frames / fmt::format("{:06}.png", i)).string(),
                                    grey,
                                    {cv::IMWRITE_PNG_COMPRESSION, 1}));
        }
    }
    const Outcome outcome = run(kCalibrate + "--recording take -o rig.toml");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    expect_the_rig("rig.toml");
}

// GigE Vision in a private network; the site's file names cameras, and a rig that is yet to be
// made.
TEST_F(SweepProgram, MakesARigOfCamerasOverTheirProtocol) {
    std::ofstream site(folder_ / "site.toml");
    site << "[site]\nname = \"lab\"\n[capture]\nsource = \"cameras\"\nrig = \"rig.toml\"\n"
            "rate_hz = 15.0\ntrigger = \"free-run\"\n[hull]\nmin_views = 3\n";
    for (std::size_t c = 0; c < rig_.cameras.size(); ++c)
        site << fmt::format(
            "[[capture.camera]]\nname = \"{0}\"\nserial = \"{0}\"\naddress = \"127.0.0.{1}\"\n",
            rig_.cameras[c].name,
            c + 2);
    site.close();
    const Outcome outcome =
        run(std::string(ATRIUM_BIN_DIR) +
            "/simulated_cameras --log-level warn --rig true.toml --rate_hz 15 --simulation.shows "
            "wand -- " +
            kCalibrate + "--config site.toml --instants 80 -o rig.toml");
    if (outcome.output.find("a network namespace cannot be made") != std::string::npos)
        GTEST_SKIP() << test::skip::kNoNetwork << outcome.output;
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    expect_the_rig("rig.toml");
}

TEST_F(SweepProgram, SaysWhyThereIsNothingToSolve) {
    // one level of light is no light: the exposure is far too short for the threshold
    const Outcome outcome = run("timeout --preserve-status -s INT 8 " + kCalibrate + kSimulated +
                                "--light-threshold 250 -o rig.toml");
    EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("show the moving wand in two cameras at once"));
    EXPECT_THAT(outcome.output, HasSubstr("check: camera 'cam0' sees no light: is it covered"));
    EXPECT_FALSE(fs::exists(folder_ / "rig.toml"));
}

}  // namespace
}  // namespace atrium::calibrate
