#include "tools/simulated_cameras/command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>

namespace atrium::simulated_cameras {
namespace {

int exit_code_of(const std::vector<std::string>& command) {
    const auto code = run_command(command, std::stop_token(), [] {});
    return code ? *code : -1;
}

TEST(Command, ReturnsTheExitCode) {
    EXPECT_EQ(exit_code_of({"sh", "-c", "exit 0"}), 0);
    EXPECT_EQ(exit_code_of({"sh", "-c", "exit 42"}), 42);
    EXPECT_EQ(exit_code_of({"sh", "-c", "kill -KILL $$"}), 128 + SIGKILL);
}

TEST(Command, NamesAMissingProgram) {
    const auto code = run_command({"/nonexistent/program"}, std::stop_token(), [] {});
    ASSERT_FALSE(code);
    EXPECT_EQ(code.error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(code.error().message, testing::HasSubstr("/nonexistent/program"));
}

TEST(Command, StopEndsIt) {
    std::stop_source stop;
    stop.request_stop();
    const auto begin = std::chrono::steady_clock::now();
    const auto code = run_command({"sleep", "60"}, stop.get_token(), [] {});
    ASSERT_TRUE(code);
    EXPECT_EQ(*code, 128 + SIGTERM);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
    EXPECT_EQ(run_command({}, stop.get_token(), [] {}), 0);
}

TEST(Command, ReportsItsSignal) {
    block_usr1();
    int num_signals = 0;
    // the command ends only after the signal has arrived, because `on_signal` stops it
    std::stop_source stop;
    const auto code =
        run_command({"sh", "-c", "kill -USR1 $PPID; exec sleep 60"}, stop.get_token(), [&] {
            ++num_signals;
            stop.request_stop();
        });
    ASSERT_TRUE(code);
    EXPECT_EQ(num_signals, 1);
}

}  // namespace
}  // namespace atrium::simulated_cameras
