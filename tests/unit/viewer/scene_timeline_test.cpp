#include "viewer/scene_timeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using std::chrono::milliseconds;

constexpr auto kPeriod = milliseconds(20);

// One object that moves along x at 2 m/s.
bus::SceneState state_at(int step) {
    bus::SceneState state;
    state.world = "w";
    state.tick = static_cast<std::uint64_t>(step);
    state.time = Timestamp{1'000'000'000'000} + step * kPeriod;
    bus::ObjectState object;
    object.object = 7;
    object.world_from_object.translation.x() = 0.04 * step;
    object.linear_velocity.x() = 2.0;
    state.objects.push_back(object);
    return state;
}

class SceneTimelineTest : public testing::Test {
protected:
    const SceneTimeline::Clock::time_point begin_{std::chrono::seconds(5000)};
    SceneTimeline sut_;
    std::vector<bus::ObjectState> objects_;

    double x_at(SceneTimeline::Clock::time_point now) {
        sut_.sample(now, objects_);
        EXPECT_EQ(objects_.size(), 1u);
        return objects_.empty() ? -1.0 : objects_[0].world_from_object.translation.x();
    }
    void feed(int first, int last) {
        for (int step = first; step <= last; ++step)
            sut_.add(state_at(step), begin_ + step * kPeriod);
    }
};

TEST_F(SceneTimelineTest, IsEmptyUntilAStateHasCome) {
    sut_.sample(begin_, objects_);
    EXPECT_TRUE(objects_.empty());
}

TEST_F(SceneTimelineTest, ShowsWhatWasOnePeriodAgo) {
    feed(0, 10);
    for (int ms = 0; ms <= 20; ms += 4) {
        const auto now = begin_ + 10 * kPeriod + milliseconds(ms);
        EXPECT_NEAR(x_at(now), 0.36 + 0.002 * ms, 1e-6) << ms;
    }
}

TEST_F(SceneTimelineTest, MovesOnWithTheLastVelocityAndThenStops) {
    feed(0, 10);
    const auto last = begin_ + 10 * kPeriod;
    EXPECT_NEAR(x_at(last + kPeriod + milliseconds(30)), 0.40 + 0.06, 1e-6);
    EXPECT_NEAR(x_at(last + kPeriod + milliseconds(500)), 0.40 + 0.10, 1e-6);  // 50 ms of 2 m/s
}

TEST_F(SceneTimelineTest, JitterOfTheArrivalsDoesNotShow) {
    const int jitter_ms[] = {0, 7, 2, 11, 0, 5, 9, 1, 3, 8, 0, 4};
    double previous = -1.0;
    for (int step = 0; step < 12; ++step) {
        sut_.add(state_at(step), begin_ + step * kPeriod + milliseconds(jitter_ms[step]));
        if (step < 2) continue;
        const double x = x_at(begin_ + step * kPeriod + milliseconds(12));
        if (previous >= 0.0) {
            EXPECT_NEAR(x - previous, 0.04, 2e-3) << step;
        }
        previous = x;
    }
}

TEST_F(SceneTimelineTest, AResetIsNotInterpolated) {
    feed(0, 10);
    bus::SceneState reset = state_at(11);
    reset.objects[0].world_from_object.translation.x() = -5.0;
    sut_.add(reset, begin_ + 11 * kPeriod);
    EXPECT_NEAR(x_at(begin_ + 11 * kPeriod + milliseconds(10)), -5.0, 1e-9);
}

TEST_F(SceneTimelineTest, AWorldThatStartsAgainIsFollowedAtOnce) {
    feed(500, 510);
    bus::SceneState fresh = state_at(0);
    fresh.time = Timestamp{2'000'000'000};
    fresh.objects[0].world_from_object.translation.x() = 9.0;
    sut_.add(fresh, begin_ + 511 * kPeriod);
    EXPECT_NEAR(x_at(begin_ + 511 * kPeriod), 9.0, 1e-9);
}

TEST_F(SceneTimelineTest, ObjectsThatAppearAreShownWhereTheyAre) {
    feed(0, 3);
    bus::SceneState more = state_at(4);
    more.objects.push_back(more.objects[0]);
    more.objects[1].object = 8;
    sut_.add(more, begin_ + 4 * kPeriod);
    sut_.sample(begin_ + 4 * kPeriod + milliseconds(10), objects_);
    EXPECT_EQ(objects_.size(), 2u);
}

}  // namespace
}  // namespace atrium::viewer
