#include "site_node/stage_times.hpp"

#include <gtest/gtest.h>

namespace atrium::site_node {
namespace {

using namespace std::chrono_literals;

TEST(StageTimes, AreMediansAndBytesPerSecondOfEachTopic) {
    StageTimes times;
    bus::SiteStatus status;
    times.put_into(status);
    EXPECT_EQ(status.stages, bus::StageTimes{}) << "all times must be zero before a measurement";
    const std::chrono::steady_clock::time_point begin{100s};
    times.update_rates(begin);
    for (const double ms : {1.0, 2.0, 30.0}) {
        times.computed({.silhouettes = ms, .hull = 10 * ms, .encode = 100 * ms, .total = 111 * ms});
        times.published(500, 7000, 3ms);
    }
    times.update_rates(begin + 2s);
    times.put_into(status);
    EXPECT_EQ(status.stages, (bus::StageTimes{2.0, 20.0, 200.0, 3.0}));
    EXPECT_DOUBLE_EQ(status.mesh_bytes_per_s, 750.0);
    EXPECT_DOUBLE_EQ(status.texture_bytes_per_s, 10'500.0);
    times.update_rates(begin + 3s);
    times.put_into(status);
    EXPECT_EQ(status.mesh_bytes_per_s, 0.0) << "the rate must be zero if nothing was sent since";
}

}  // namespace
}  // namespace atrium::site_node
