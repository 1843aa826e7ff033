#include "core/bus/bus.hpp"
#include "tests/support/network/hosted_process.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

// The programs run with the configured niceness and report it.
namespace atrium {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

constexpr const char* kWorld = "niceness-test";
constexpr std::uint32_t kDomain = 184;  // used by this test only
constexpr seconds kPatience{60};

template <typename T>
T value(Expected<T> expected) {
    if (!expected) throw std::runtime_error(expected.error().message);
    return std::move(*expected);
}

std::unique_ptr<test::HostedProcess> start(const std::string& program,
                                           std::vector<std::string> arguments) {
    std::vector<std::string> command{std::string(ATRIUM_BIN_DIR) + "/" + program};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(), {"--bus.world", kWorld, "--bus.domain", std::to_string(kDomain)});
    return value(test::HostedProcess::start(command));
}

// Niceness in the first status with a measured interval.
template <typename Status>
ProcessorUse first_use() {
    bus::BusOptions options;
    options.world = kWorld;
    options.domain = kDomain;
    const bus::Participant participant = value(bus::Participant::create(options));
    auto waiter = value(bus::Waiter::create(participant));
    auto reader = value(bus::Reader<Status>::create(participant));
    waiter.add(reader);
    ProcessorUse use;
    for (const auto give_up = Clock::now() + kPatience;
         use.run_per_s == 0.0 && Clock::now() < give_up;) {
        waiter.wait(std::chrono::milliseconds(500));
        reader.take([&](Status&& status) { use = status.processor; });
    }
    return use;
}

// A library may raise the niceness of its own background threads. Mesa does so for shader
// compilation and its cache.
void expect_no_thread_goes_before(pid_t process, int nice) {
    int num_threads = 0;
    for (const auto& thread :
         std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task")) {
        const auto id = static_cast<id_t>(std::stoul(thread.path().filename().string()));
        EXPECT_GE(getpriority(PRIO_PROCESS, id), nice) << "thread " << id;
        ++num_threads;
    }
    EXPECT_GT(num_threads, 1);
    EXPECT_EQ(getpriority(PRIO_PROCESS, static_cast<id_t>(process)), nice);
}

TEST(Niceness, OfTheWorldServerIsAsConfigured) {
    const auto server = start("world_server", {"--process.nice", "7"});
    const ProcessorUse use = first_use<bus::WorldStatus>();
    EXPECT_EQ(use.nice, 7) << server->output();
    EXPECT_GT(use.run_per_s, 0.0) << server->output();
    expect_no_thread_goes_before(server->id(), 7);
}

TEST(Niceness, OfTheViewerIsTwoByDefault) {
    const auto viewer =
        start("viewer", {"--headless", "--view.width", "64", "--view.height", "36"});
    const ProcessorUse use = first_use<bus::ViewerStatus>();
    const int expected = std::max(2, getpriority(PRIO_PROCESS, 0));
    EXPECT_EQ(use.nice, expected) << viewer->output();
    expect_no_thread_goes_before(viewer->id(), expected);
}

}  // namespace
}  // namespace atrium
