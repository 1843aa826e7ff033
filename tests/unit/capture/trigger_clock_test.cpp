#include "site_node/capture/trigger_clock.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace atrium::capture {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPeriod{40};
constexpr milliseconds kDelay{70};  // nearly two periods
constexpr Timestamp kStart{1'700'000'000'000'000'000};

// Times are relative to kStart. A camera delivers a picture kDelay after its capture.
Timestamp site_time(double ms) { return {kStart.ns + static_cast<std::int64_t>(ms * 1e6)}; }

class MeasuredClock : public testing::Test {
protected:
    MeasuredClock() {
        clock_.start_measuring();
        clock_.finish_measuring(kDelay);
    }
    std::optional<Timestamp> taken(double ms) { return clock_.on_picture(site_time(ms) + kDelay); }

    TriggerClock clock_{kPeriod};
};

TEST(TriggerClock, PassesPicturesThroughWithoutMeasurement) {
    TriggerClock clock(kPeriod);
    EXPECT_EQ(clock.on_picture(site_time(3)), site_time(3));
    clock.start_measuring();
    clock.finish_measuring(std::nullopt);
    EXPECT_EQ(clock.on_picture(site_time(5)), site_time(5));
    EXPECT_EQ(clock.on_lost_picture(site_time(6)), site_time(6));
    EXPECT_FALSE(clock.delay());
}

TEST(TriggerClock, PassesOnePicturePerShotWhileMeasuring) {
    TriggerClock clock(kPeriod);
    clock.start_measuring();
    clock.begin_shot();
    std::thread camera([&] {
        EXPECT_FALSE(clock.on_picture(site_time(70)));
        EXPECT_FALSE(clock.on_picture(site_time(71)));
    });
    EXPECT_EQ(clock.wait_for_picture({}, std::chrono::seconds(20)), site_time(70));
    camera.join();
    clock.begin_shot();
    EXPECT_FALSE(clock.wait_for_picture({}, milliseconds(1)));
    std::stop_source stop;
    stop.request_stop();
    EXPECT_FALSE(clock.wait_for_picture(stop.get_token(), std::chrono::hours(1)));
    EXPECT_FALSE(clock.on_lost_picture(site_time(70)));
}

TEST_F(MeasuredClock, AssignsAPictureToTheTriggerBeforeIt) {
    for (int beat = 0; beat < 200; ++beat) {
        const double due_ms = 40.0 * beat;
        clock_.note_trigger(site_time(due_ms), site_time(due_ms + 1));
        // two more triggers have been sent within the delay of nearly two periods
        if (beat >= 2) {
            EXPECT_EQ(taken(due_ms - 80 + 3), site_time(due_ms - 80 + 3)) << beat;
        }
    }
}

TEST_F(MeasuredClock, SeparatesTriggersMoreThanPicturesOfOneTrigger) {
    for (int beat = 0; beat < 2; ++beat) {
        const double due_ms = 40.0 * beat;
        clock_.note_trigger(site_time(due_ms), site_time(due_ms + 10));  // as late as allowed
    }
    std::vector<double> accepted_ms;
    for (double ms = -30; ms < 90; ms += 0.25) {
        if (const auto time = taken(ms))
            accepted_ms.push_back(static_cast<double>((*time - kStart).count()) * 1e-6);
    }
    ASSERT_FALSE(accepted_ms.empty());
    for (const double ms : accepted_ms) {
        const double after_beat_ms = ms < 40.0 ? ms : ms - 40.0;
        EXPECT_GE(after_beat_ms, 0.0);
        EXPECT_LT(after_beat_ms, 15.0);  // 3/8 of the period
    }
}

TEST_F(MeasuredClock, RefusesPicturesWithoutATrigger) {
    EXPECT_FALSE(taken(0));
    clock_.note_trigger(site_time(0), site_time(0));
    EXPECT_FALSE(taken(20));
    EXPECT_FALSE(taken(-20));
    EXPECT_FALSE(clock_.on_lost_picture(site_time(20) + kDelay));
    EXPECT_TRUE(clock_.on_lost_picture(site_time(2) + kDelay));
    EXPECT_TRUE(taken(2));
}

TEST_F(MeasuredClock, CorrectsADelayThatWasMeasuredTooLong) {
    clock_.note_trigger(site_time(0), site_time(0));
    EXPECT_EQ(clock_.on_picture(site_time(2) + milliseconds(64)),
              site_time(0));  // not before the trigger
    EXPECT_EQ(clock_.delay(), milliseconds(66));
    clock_.note_trigger(site_time(40), site_time(40));
    EXPECT_EQ(clock_.on_picture(site_time(42) + milliseconds(64)), site_time(40));
}

TEST_F(MeasuredClock, IsAstrayWhenNoPictureMatches) {
    for (int beat = 0; beat < 45; ++beat) {
        clock_.note_trigger(site_time(40.0 * beat), site_time(40.0 * beat));
        EXPECT_EQ(clock_.needs_measuring(), beat >= 40) << beat;
        EXPECT_FALSE(taken(40.0 * beat + 20));
    }
    clock_.start_measuring();
    EXPECT_FALSE(clock_.needs_measuring());
}

}  // namespace
}  // namespace atrium::capture
