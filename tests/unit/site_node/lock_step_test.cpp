#include "site_node/lock_step.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace atrium::site_node {
namespace {

TEST(LockStep, WaitsUntilEveryMetaframeHasLeft) {
    LockStep step;
    std::atomic<int> num_finished{0};
    std::jthread worker([&] {
        for (int i = 0; i < 100; ++i) {
            ++num_finished;
            step.finish();
        }
    });
    for (std::uint64_t begun = 1; begun <= 100; ++begun) {
        step.wait(begun, {});
        EXPECT_GE(num_finished, static_cast<int>(begun));
    }
}

TEST(LockStep, AStopEndsTheWait) {
    LockStep step;
    std::stop_source stop;
    std::jthread stopper([&] { stop.request_stop(); });
    step.wait(1, stop.get_token());
    EXPECT_TRUE(stop.stop_requested());
}

}  // namespace
}  // namespace atrium::site_node
