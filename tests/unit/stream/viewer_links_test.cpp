#include "site_node/stream/viewer_links.hpp"

#include "time_at.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace atrium::stream {
namespace {

// Two seconds. `queue_ms` of delay builds up at their end.
void tell(ViewerLinks& links, const std::string& viewer, double bit_per_s, bool has_queue) {
    for (int i = 0; i <= 10; ++i) {
        const double delay_ms = has_queue && i > 7 ? 100.0 : 20.0;
        links.add(viewer, {6, 0, 54, bit_per_s, delay_ms, delay_ms}, 40e6, at(0.2 * i));
    }
}

TEST(ViewerLinks, HasNoCapWithoutViewersAndOptions) {
    const ViewerLinks links({});
    EXPECT_EQ(links.cap(at(0)).cap.bit_per_s, 0.0);
    EXPECT_EQ(links.cap(at(0)).set_by, "");
}

TEST(ViewerLinks, AppliesTheOptionWithoutViewers) {
    const ViewerLinks links({.max_mbit_per_s = 6.0});
    EXPECT_EQ(links.cap(at(0)).cap.bit_per_s, 6e6);
    EXPECT_EQ(links.cap(at(0)).cap.paced_bit_per_s, 6e6);
    EXPECT_EQ(links.cap(at(0)).set_by, kMaxOption);
}

TEST(ViewerLinks, SlowestViewerSetsTheCap) {
    ViewerLinks links({});
    tell(links, "fast", 30e6, false);
    EXPECT_EQ(links.cap(at(2)).set_by, "");
    tell(links, "slow", 5e6, true);
    tell(links, "middling", 12e6, true);
    const StreamCap cap = links.cap(at(2));
    EXPECT_EQ(cap.set_by, "slow");
    EXPECT_NEAR(cap.cap.bit_per_s, 0.85 * 5e6, 1e-3);
    EXPECT_LT(cap.cap.paced_bit_per_s, cap.cap.bit_per_s);
    EXPECT_NEAR(cap.queue_ms, 80.0, 1e-6);
}

TEST(ViewerLinks, IgnoresViewersThatAreSilentForASecond) {
    ViewerLinks links({});
    tell(links, "slow", 5e6, true);
    EXPECT_EQ(links.cap(at(2.9)).set_by, "slow");
    EXPECT_EQ(links.cap(at(3.1)).set_by, "");
}

TEST(ViewerLinks, IgnoresViewersThatLeft) {
    ViewerLinks links({});
    tell(links, "slow", 5e6, true);
    links.forget("slow");
    EXPECT_EQ(links.cap(at(2)).set_by, "");
}

TEST(ViewerLinks, VerySlowViewerDoesNotRuinTheOthers) {
    ViewerLinks links({.min_mbit_per_s = 2.0});
    tell(links, "slow", 0.3e6, true);
    const StreamCap cap = links.cap(at(2));
    EXPECT_EQ(cap.cap.bit_per_s, 2e6);
    EXPECT_EQ(cap.cap.paced_bit_per_s, 2e6);
    EXPECT_EQ(cap.set_by, kMinOption);
}

TEST(ViewerLinks, MaximumOverridesTheMinimum) {
    ViewerLinks links({.max_mbit_per_s = 1.0, .min_mbit_per_s = 2.0});
    tell(links, "slow", 0.3e6, true);
    EXPECT_EQ(links.cap(at(2)).cap.bit_per_s, 1e6);
}

TEST(ViewerLinks, IgnoresReportsIfAdaptationIsOff) {
    ViewerLinks links({.adapt = false});
    tell(links, "slow", 5e6, true);
    EXPECT_EQ(links.cap(at(2)).set_by, "");
    EXPECT_EQ(links.size(), 0u);
}

TEST(ViewerLinks, BoundsTheNumberOfViewers) {
    ViewerLinks links({});
    for (int i = 0; i < 10'000; ++i)
        links.add("v" + std::to_string(i), {1, 0, 1, 1e6, 10.0, 10.0}, 0.0, at(0.001 * i));
    EXPECT_EQ(links.size(), 64u);
    links.add("later", {1, 0, 1, 1e6, 10.0, 10.0}, 0.0, at(60.0));
    EXPECT_EQ(links.size(), 1u);
}

}  // namespace
}  // namespace atrium::stream
