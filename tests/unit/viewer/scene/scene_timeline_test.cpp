#include "viewer/scene/scene_timeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::viewer {
namespace {

using std::chrono::milliseconds;

constexpr auto kStatePeriod = milliseconds(20);

// One object that moves along x at 2 m/s.
bus::SceneState state_at(int step) {
    bus::SceneState state;
    state.world = "w";
    state.tick = static_cast<std::uint64_t>(step);
    state.time = Timestamp{1'000'000'000'000} + step * kStatePeriod;
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
            sut_.add(state_at(step), begin_ + step * kStatePeriod);
    }
};

TEST_F(SceneTimelineTest, IsEmptyUntilAStateArrives) {
    sut_.sample(begin_, objects_);
    EXPECT_TRUE(objects_.empty());
}

TEST_F(SceneTimelineTest, ShowsTheStateOfOnePeriodAgo) {
    feed(0, 10);
    for (int ms = 0; ms <= 20; ms += 4) {
        const auto now = begin_ + 10 * kStatePeriod + milliseconds(ms);
        EXPECT_NEAR(x_at(now), 0.36 + 0.002 * ms, 1e-6) << ms;
    }
}

TEST_F(SceneTimelineTest, ExtrapolatesBrieflyThenStops) {
    feed(0, 10);
    const auto last = begin_ + 10 * kStatePeriod;
    EXPECT_NEAR(x_at(last + kStatePeriod + milliseconds(30)), 0.40 + 0.06, 1e-6);
    EXPECT_NEAR(
        x_at(last + kStatePeriod + milliseconds(500)), 0.40 + 0.10, 1e-6);  // 50 ms at 2 m/s
}

TEST_F(SceneTimelineTest, HidesJitterOfArrivals) {
    const int jitter_ms[] = {0, 7, 2, 11, 0, 5, 9, 1, 3, 8, 0, 4};
    double previous = -1.0;
    for (int step = 0; step < 12; ++step) {
        sut_.add(state_at(step), begin_ + step * kStatePeriod + milliseconds(jitter_ms[step]));
        if (step < 2) continue;
        const double x = x_at(begin_ + step * kStatePeriod + milliseconds(12));
        if (previous >= 0.0) {
            EXPECT_NEAR(x - previous, 0.04, 2e-3) << step;
        }
        previous = x;
    }
}

TEST_F(SceneTimelineTest, DoesNotInterpolateAcrossAReset) {
    feed(0, 10);
    bus::SceneState reset = state_at(11);
    reset.objects[0].world_from_object.translation.x() = -5.0;
    sut_.add(reset, begin_ + 11 * kStatePeriod);
    EXPECT_NEAR(x_at(begin_ + 11 * kStatePeriod + milliseconds(10)), -5.0, 1e-9);
}

TEST_F(SceneTimelineTest, FollowsARestartedWorldAtOnce) {
    feed(500, 510);
    bus::SceneState fresh = state_at(0);
    fresh.time = Timestamp{2'000'000'000};
    fresh.objects[0].world_from_object.translation.x() = 9.0;
    sut_.add(fresh, begin_ + 511 * kStatePeriod);
    EXPECT_NEAR(x_at(begin_ + 511 * kStatePeriod), 9.0, 1e-9);
}

TEST_F(SceneTimelineTest, ShowsNewObjectsAtTheirPlace) {
    feed(0, 3);
    bus::SceneState more = state_at(4);
    more.objects.push_back(more.objects[0]);
    more.objects[1].object = 8;
    sut_.add(more, begin_ + 4 * kStatePeriod);
    sut_.sample(begin_ + 4 * kStatePeriod + milliseconds(10), objects_);
    EXPECT_EQ(objects_.size(), 2u);
}

// Two viewers of one world, one far and one near. Their links lose and delay states differently,
// and their clocks differ. For the same time stamp both show the same place within 5 mm.
TEST(TwoViewers, ShowTheSamePlaceForTheSameTime) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    constexpr auto kSendPeriod = std::chrono::nanoseconds(16'666'667);
    const auto make_state = [&](int step) {
        const double t = step / 60.0;
        const double flight_s = std::fmod(t, 0.8);  // thrown up at 3.9 m/s again and again
        bus::SceneState state;
        state.time = Timestamp{1'000'000'000'000} + step * kSendPeriod;
        bus::ObjectState object;
        object.object = 7;
        object.world_from_object.translation = {
            0.3 * std::sin(8 * t), 2.0 * t, 3.924 * flight_s - 4.905 * flight_s * flight_s};
        object.linear_velocity = {2.4 * std::cos(8 * t), 2.0, 3.924 - 9.81 * flight_s};
        state.objects.push_back(object);
        return state;
    };
    SceneTimeline near;
    SceneTimeline far;
    std::vector<bus::ObjectState> seen_near;
    std::vector<bus::ObjectState> seen_far;
    const SceneTimeline::Clock::time_point near_clock{std::chrono::seconds(5000)};
    const SceneTimeline::Clock::time_point far_clock{std::chrono::seconds(90)};
    double largest_m = 0.0;
    int num_compared = 0;
    for (int step = 0; step < 600; ++step) {
        const auto way = [&](double least_ms, double jitter_ms) {
            return std::chrono::nanoseconds(
                static_cast<std::int64_t>(1e6 * (least_ms + jitter_ms * chance(random))));
        };
        near.add(make_state(step), near_clock + step * kSendPeriod + way(0.2, 0.5));
        if (chance(random) > 0.05)
            far.add(make_state(step), far_clock + step * kSendPeriod + way(60.0, 8.0));
        if (step < 30) continue;
        // the time that the far viewer shows now is in the past of the near viewer, which still has
        // it
        const auto time = far.shown_time(far_clock + step * kSendPeriod + way(62.0, 10.0));
        ASSERT_TRUE(time);
        const double phase_s =
            std::fmod((*time - Timestamp{1'000'000'000'000}).count() * 1e-9, 0.8);
        if (phase_s < 0.06 || phase_s > 0.74) continue;  // the throw itself lies between two states
        near.sample_at(*time, seen_near);
        far.sample_at(*time, seen_far);
        ASSERT_EQ(seen_near.size(), 1U);
        ASSERT_EQ(seen_far.size(), 1U);
        largest_m = std::max(
            largest_m,
            (seen_near[0].world_from_object.translation - seen_far[0].world_from_object.translation)
                .norm());
        ++num_compared;
    }
    EXPECT_GT(num_compared, 300);
    EXPECT_LT(largest_m, 0.005);
}

}  // namespace
}  // namespace atrium::viewer
