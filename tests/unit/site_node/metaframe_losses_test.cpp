#include "site_node/metaframe_losses.hpp"

#include "core/bus/checks.hpp"
#include "core/bus/limits.hpp"

#include <gtest/gtest.h>

namespace atrium::site_node {
namespace {

TEST(MetaframeLosses, AddsUpAndShowsOnlyNonZeroCounts) {
    bus::SiteStatus status;
    EXPECT_EQ(losses_line({}, status), "");
    add(MetaframeLosses{1, 2, 3, 0.5, 4, 5, 6}, status.left_out);
    const bus::SiteStatus former = status;
    EXPECT_EQ(losses_line(former, status), "");
    status.num_incomplete_used = 7;
    add(MetaframeLosses{10, 20, 30, 0.25, 40, 50, 60}, status.left_out);
    EXPECT_EQ(status.left_out, (bus::LeftOutTotals{11, 22, 33, 0.75, 44, 55, 66}));
    EXPECT_EQ(losses_line({}, status),
              "incomplete_used=7 cameras=11 phantoms=22 fragments=33 dropped_l=0.75 "
              "contours_dropped=44 contours_repaired=55 regions_failed=66");
    EXPECT_EQ(losses_line(former, status),
              "incomplete_used=7 cameras=10 phantoms=20 fragments=30 dropped_l=0.25 "
              "contours_dropped=40 contours_repaired=50 regions_failed=60");
}

// The bus does not send a status that exceeds a limit.
TEST(MetaframeLosses, StaysWithinTheLimitsOfAStatus) {
    bus::SiteStatus status;
    status.site = "lab";
    for (int i = 0; i < 2; ++i) add(MetaframeLosses{.dropped_l = 0.8e15}, status.left_out);
    EXPECT_TRUE(bus::check(status));
    EXPECT_EQ(status.left_out.dropped_l, bus::kMaxStatistic);
}

}  // namespace
}  // namespace atrium::site_node
