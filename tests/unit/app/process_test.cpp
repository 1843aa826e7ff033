#include "core/app/process.hpp"

#include "core/base/processor_use.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <latch>
#include <string>
#include <thread>

namespace atrium::app {
namespace {

TEST(ParseStartTicks, FindsTheFieldAfterAnyProcessName) {
    const std::string rest = " S 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 4711 20 21\n";
    EXPECT_EQ(parse_start_ticks("12 (viewer)" + rest), 4711U);
    EXPECT_EQ(parse_start_ticks("12 (a ) (b) 9 9)" + rest), 4711U);
    EXPECT_EQ(parse_start_ticks("12 (x) S 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 4711"),
              4711U);
}

TEST(ParseStartTicks, RefusesMalformedLines) {
    for (const char* text : {"",
                             "12 viewer S 1 2",
                             "12 (viewer)",
                             "12 (viewer) S 1 2 3",
                             "12 (x) S 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 ",
                             "12 (x) S 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 -4 20",
                             "12 (x) S 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 4x 20"}) {
        EXPECT_FALSE(parse_start_ticks(text).has_value()) << text;
    }
}

TEST(SecondsSinceStart, GrowsWhileTheProcessRuns) {
    const double first_s = seconds_since_start();
    EXPECT_GT(first_s, 0.0);
    EXPECT_LT(first_s, 3600.0);
    EXPECT_GE(seconds_since_start(), first_s);
}

// Whether every thread of this process has this niceness.
bool all_threads_have(int nice) {
    int num_threads = 0;
    for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
        const auto id = static_cast<id_t>(std::stoul(thread.path().filename().string()));
        if (getpriority(PRIO_PROCESS, id) != nice) return false;
        ++num_threads;
    }
    return num_threads > 1;
}

// Runs in a child process with a thread that already runs, because niceness cannot be taken back.
bool holds_in_child(const std::function<bool()>& promise) {
    const pid_t child = fork();
    if (child == 0) {
        std::latch end(1);
        std::jthread other([&] { end.wait(); });
        const bool holds = promise();
        end.count_down();
        other.join();
        _exit(holds ? 0 : 1);
    }
    int status = 0;
    return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Niceness, AppliesToAllThreadsAndIsInTheStatus) {
    EXPECT_TRUE(holds_in_child([] {
        const bool is_set = apply({.nice = 7}) == 7 && all_threads_have(7);
        bool is_inherited = false;
        std::thread([&] {
            is_inherited = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())) == 7;
        }).join();
        return is_set && is_inherited && ProcessorMeter().update().nice == 7;
    }));
}

TEST(Niceness, KeepsAHigherValueFromTheStartOfTheProcess) {
    EXPECT_TRUE(holds_in_child([] {
        return apply({.nice = 9}) == 9 && apply({.nice = 5}) == 9 && apply({.nice = 0}) == 9 &&
               all_threads_have(9);
    }));
}

TEST(Niceness, StaysUnchangedWithAWarningIfNegativeValuesAreRefused) {
    EXPECT_TRUE(holds_in_child([] {
        // as an ordinary user without limits that allow it
        const rlimit none{0, 0};
        if (setrlimit(RLIMIT_NICE, &none) != 0) return false;
        if (getuid() == 0 && setresuid(65534, 65534, 65534) != 0) return false;
        testing::internal::CaptureStderr();
        const int now = apply({.nice = -5});
        const std::string log = testing::internal::GetCapturedStderr();
        return now == 0 && log.find("niceness_refused wanted=-5 has=0") != std::string::npos;
    }));
}

TEST(ProgramFolder, HoldsTheRunningExecutable) {
    EXPECT_TRUE(std::filesystem::equivalent(program_folder() / "app_test", "/proc/self/exe"));
}

}  // namespace
}  // namespace atrium::app
