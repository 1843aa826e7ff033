#include "tests/support/run_program.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

// Eight GigE Vision cameras of one megapixel at 20 Hz, over the real protocol in a private network,
// through Aravis into hulls. Checks every metaframe, also while cameras fail.
// bench/site/cameras_60s.sh does the same for a minute.
namespace atrium {
namespace {

namespace fs = std::filesystem;

using test_support::Outcome;

Outcome run(const std::string& command) { return test_support::run_program(command, 150); }

const std::string kSimulatedCameras = ATRIUM_BIN_DIR "/simulated_cameras";
const std::string kClient = ATRIUM_BIN_DIR "/cameras_client";
const std::string kRig = atrium::test::source_dir() + "/deploy/rigs/full_body_1mp.toml";

class Cameras : public testing::Test {
protected:
    void SetUp() override {
        const std::string rig = atrium::test::source_dir() + "/deploy/rigs/full_body.toml";
        const Outcome probe =
            run(kSimulatedCameras + " --rig " + rig +
                " --simulation.loop_s 0.1 --simulation.cache .cache/cameras_test -- true");
        if (probe.output.find("a network namespace cannot be made") != std::string::npos)
            GTEST_SKIP() << atrium::test::skip::kNoNetwork << probe.output;
        ASSERT_EQ(probe.exit_code, 0) << probe.output;
    }

    static std::string serve(const std::string& options) {
        return kSimulatedCameras + " --log-level warn --rig " + kRig +
               " --stamp --empty_seconds 6 --simulation.loop_s 1 "
               "--simulation.cache .cache/cameras_test " +
               options + " -- ";
    }
    static std::string watch(const std::string& options) {
        return kClient + " --log-level warn --rig " + kRig + " " + options;
    }

    static void expect_good(const Outcome& outcome) {
        EXPECT_EQ(outcome.exit_code, 0);
        EXPECT_TRUE(outcome.output.find("all is as it must be") != std::string::npos);
        std::printf("%s", outcome.output.c_str());
    }
};

// Times count from the first picture. Learning the background takes the first one or two seconds.
TEST_F(Cameras, SiteContinuesWhileCamerasStopRestartAndLosePackets) {
    expect_good(run(serve("--rate_hz 20 --lose cam3=1 --stop cam2@6+2 --restart cam5@9") +
                    watch("--rate_hz 20 --seconds 10 --outages cam2=2,cam5=0 --lossy cam3 "
                          "--num_background_frames 8")));
}

// The site drops late pictures: a busy machine loses metaframes, but mixes none.
TEST_F(Cameras, SoftwareTriggersShowOneInstant) {
    expect_good(
        run(serve("--rate_hz 20") +
            watch("--rate_hz 20 --seconds 6 --num_background_frames 4 --trigger software")));
}

// More than half a period between shutter and arrival. Only the site's own triggers distinguish
// that from the next trigger.
TEST_F(Cameras, LongDelayOfOneCameraMixesNoTriggers) {
    expect_good(run(serve("--rate_hz 10 --delay_ms cam2=70") +
                    watch("--rate_hz 10 --seconds 6 --num_background_frames 4 --trigger software "
                          "--deadline_ms 150")));
}

}  // namespace
}  // namespace atrium
