#include "tests/support/run_program.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

// Eight GigE Vision cameras of one megapixel at 20 Hz, over the real protocol in a network of their
// own, through Aravis into hulls: what is true of every metaframe, and what happens while cameras
// fail. bench/cameras_60s.sh is the same for a minute.
namespace atrium {
namespace {

namespace fs = std::filesystem;

using test_support::Outcome;

Outcome run(const std::string& command) { return test_support::run_program(command, 150); }

const std::string kSimulatedCameras = ATRIUM_BIN_DIR "/simulated_cameras";
const std::string kClient = ATRIUM_BIN_DIR "/cameras_client";
const std::string kRig = ATRIUM_SOURCE_DIR "/deploy/rigs/full_body_1mp.toml";

class Cameras : public testing::Test {
protected:
    void SetUp() override {
        const std::string rig = ATRIUM_SOURCE_DIR "/deploy/rigs/full_body.toml";
        const Outcome probe =
            run(kSimulatedCameras + " --rig " + rig +
                " --simulation.loop_s 0.1 --simulation.cache .cache/cameras_test -- true");
        if (probe.output.find("a network namespace cannot be made") != std::string::npos)
            GTEST_SKIP() << probe.output;
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

// Times count from the first picture; learning the background takes about four seconds of them.
TEST_F(Cameras, OneStopsOneRestartsOneLosesPacketsAndTheSiteGoesOn) {
    expect_good(run(serve("--rate_hz 20 --lose cam3=1 --stop cam2@7+2 --restart cam5@11") +
                    watch("--rate_hz 20 --seconds 10 --outages cam2=2,cam5=0 --lossy cam3 "
                          "--num_background_frames 8")));
}

// At half the rate: a trigger is on time only if the fake camera's thread gets the processor, and a
// machine that is shared may keep it waiting for a quarter of 50 ms.
TEST_F(Cameras, TriggeredByTheSiteTheyShowOneInstant) {
    expect_good(
        run(serve("--rate_hz 10") +
            watch("--rate_hz 10 --seconds 6 --num_background_frames 4 --trigger software")));
}

}  // namespace
}  // namespace atrium
