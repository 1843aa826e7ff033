#include "viewer/run_limit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;
using Now = RunLimit::Now;

const RunLimit::Clock::time_point kRunBegin{100s};

TEST(RunLimit, IsOffByDefault) {
    RunLimit limit({}, kRunBegin);
    for (int i = 1; i < 1000; ++i) {
        EXPECT_EQ(limit.update(static_cast<std::uint64_t>(i), 0, kRunBegin + i * 20ms).value(),
                  Now::kGoesOn);
    }
    EXPECT_NEAR(limit.frames_per_s(), 50.0, 1e-6);
}

TEST(RunLimit, CountsPicturesFromTheStart) {
    ViewerConfig config;
    config.frames = 3;
    RunLimit limit(config, kRunBegin);
    EXPECT_EQ(limit.update(1, 0, kRunBegin + 1s).value(), Now::kGoesOn);
    EXPECT_EQ(limit.update(2, 0, kRunBegin + 2s).value(), Now::kGoesOn);
    EXPECT_EQ(limit.update(3, 0, kRunBegin + 3s).value(), Now::kOver);
}

TEST(RunLimit, CountsPicturesAndSecondsFromTheFirstPeople) {
    ViewerConfig config;
    config.wait_people = 2;
    config.seconds = 5.0;
    RunLimit limit(config, kRunBegin);
    EXPECT_EQ(limit.update(40, 1, kRunBegin + 9s).value(), Now::kGoesOn);
    EXPECT_EQ(limit.update(50, 2, kRunBegin + 10s).value(), Now::kBegan);
    EXPECT_EQ(limit.update(60, 0, kRunBegin + 12s).value(), Now::kGoesOn);  // they may leave again
    EXPECT_NEAR(limit.frames_per_s(), 5.0, 1e-9);
    EXPECT_EQ(limit.update(99, 2, kRunBegin + 15s).value(), Now::kOver);
}

TEST(RunLimit, FailsIfNobodyComes) {
    ViewerConfig config;
    config.wait_people = 2;
    config.wait_timeout_s = 4.0;
    RunLimit limit(config, kRunBegin);
    EXPECT_EQ(limit.update(1, 1, kRunBegin + 4s).value(), Now::kGoesOn);
    const auto late = limit.update(2, 1, kRunBegin + 4001ms);
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(late.error().message, testing::HasSubstr("1 of 2 people came within 4 s"));
}

TEST(RunLimit, SaysWhereToLookForThePeople) {
    const std::string cure =
        RunLimit::cure("world=lab1 domain=0 network=lan other_worlds=labl did_you_mean=labl", {});
    EXPECT_THAT(cure, testing::HasSubstr("this viewer is in world=lab1"));
    EXPECT_THAT(cure, testing::HasSubstr("did_you_mean=labl"));
}

TEST(RunLimit, SaysThatSitesPublishNothingYet) {
    EXPECT_THAT(
        RunLimit::cure("world=lab1", {"lab"}),
        testing::HasSubstr("in world=lab1, where lab is a site and publishes nothing yet: a "
                           "site without pictures of the empty room learns it"));
    EXPECT_THAT(RunLimit::cure("world=lab1", {"a", "b"}),
                testing::AllOf(testing::HasSubstr("a, b are sites and publish nothing yet"),
                               testing::HasSubstr("wait longer with --wait_timeout_s")));
}

}  // namespace
}  // namespace atrium::viewer
