#include "viewer/scene/soft_timeline.hpp"

#include "core/bus/soft_nodes.hpp"

#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

bus::SoftBodyState state_at(std::int64_t ms, float x) {
    bus::SoftBodyState state;
    state.object = 3;
    state.time.ns = 1'000'000'000'000 + ms * 1'000'000;
    bus::quantise(std::vector<Eigen::Vector3f>{{x, 0, 1}, {x, 1, 0}}, state);
    return state;
}
Timestamp at(std::int64_t ms) { return {1'000'000'000'000 + ms * 1'000'000}; }

TEST(SoftTimeline, InterpolatesNodesLinearly) {
    SoftTimeline timeline;
    std::vector<Eigen::Vector3f> nodes;
    EXPECT_FALSE(timeline.sample(3, at(0), nodes));
    timeline.add(state_at(0, 0.0F));
    timeline.add(state_at(20, 1.0F));
    timeline.add(state_at(40, 3.0F));
    const auto x_at = [&](std::int64_t ms) {
        EXPECT_TRUE(timeline.sample(3, at(ms), nodes));
        EXPECT_EQ(nodes.size(), 2U);
        EXPECT_NEAR(nodes[1].y(), 1.0F, 1e-4F);
        return nodes[0].x();
    };
    EXPECT_NEAR(x_at(5), 0.25F, 1e-3F);
    EXPECT_NEAR(x_at(20), 1.0F, 1e-3F);
    EXPECT_NEAR(x_at(30), 2.0F, 1e-3F);
    EXPECT_NEAR(x_at(-50), 0.0F, 1e-3F) << "before the first";
    EXPECT_NEAR(x_at(100), 3.0F, 1e-3F) << "after the last";
    timeline.remove(3);
    EXPECT_FALSE(timeline.sample(3, at(0), nodes));
}

TEST(SoftTimeline, DropsLateStatesAndRestartsAfterAClockStep) {
    SoftTimeline timeline;
    std::vector<Eigen::Vector3f> nodes;
    timeline.add(state_at(0, 0.0F));
    timeline.add(state_at(20, 1.0F));
    timeline.add(state_at(10, 9.0F));
    ASSERT_TRUE(timeline.sample(3, at(10), nodes));
    EXPECT_NEAR(nodes[0].x(), 0.5F, 1e-3F);
    timeline.add(state_at(-5000, 7.0F));
    ASSERT_TRUE(timeline.sample(3, at(-5000), nodes));
    EXPECT_NEAR(nodes[0].x(), 7.0F, 1e-3F);
}

TEST(SoftTimeline, DoesNotMixStatesWithDifferentNodeCounts) {
    SoftTimeline timeline;
    std::vector<Eigen::Vector3f> nodes;
    timeline.add(state_at(0, 0.0F));
    bus::SoftBodyState other = state_at(20, 1.0F);
    other.nodes.resize(1);
    timeline.add(other);
    ASSERT_TRUE(timeline.sample(3, at(10), nodes));
    ASSERT_EQ(nodes.size(), 1U);
    EXPECT_NEAR(nodes[0].x(), 1.0F, 1e-3F);
}

}  // namespace
}  // namespace atrium::viewer
