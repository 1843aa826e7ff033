#include "site_node/hosts/clock_epoch.hpp"

#include <gtest/gtest.h>

namespace atrium::hosts {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

class ClockEpochTest : public testing::Test {
protected:
    ClockEpoch epoch() {
        return ClockEpoch(
            {[this] { return Timestamp{settable_.count()}; }, [this] { return steady_; }});
    }
    void pass(nanoseconds time, double rate = 1.0) {
        steady_ += time;
        settable_ +=
            nanoseconds(static_cast<std::int64_t>(rate * static_cast<double>(time.count())));
    }

    nanoseconds settable_ = std::chrono::hours(480'000);
    nanoseconds steady_ = std::chrono::hours(3);
};

TEST_F(ClockEpochTest, ChangesWheneverTheClockIsSet) {
    ClockEpoch sut = epoch();
    for (const auto step : {milliseconds(20), milliseconds(-1), milliseconds(3'600'000)}) {
        const std::uint64_t before = sut.current();
        pass(milliseconds(33));
        EXPECT_EQ(sut.current(), before);
        settable_ += step;
        EXPECT_NE(sut.current(), before);
        EXPECT_EQ(sut.last_step(), step);
    }
}

TEST_F(ClockEpochTest, AClockThatNtpMakesFasterIsNotSet) {
    ClockEpoch sut = epoch();
    const std::uint64_t before = sut.current();
    for (const double rate : {1.0005, 0.9995}) {
        for (int i = 0; i < 300; ++i) {
            pass(milliseconds(500), rate);
            ASSERT_EQ(sut.current(), before);
        }
    }
}

TEST_F(ClockEpochTest, DiffersBetweenProcesses) { EXPECT_NE(epoch().current(), epoch().current()); }

// A thread that loses its core between the two clocks sees a difference that is none.
TEST_F(ClockEpochTest, ALostCoreIsNotASetClock) {
    int looks = 0;
    ClockEpoch sut({[&] {
                        if (++looks % 3 == 1) pass(milliseconds(10));
                        return Timestamp{settable_.count()};
                    },
                    [this] { return steady_; }});
    const std::uint64_t before = sut.current();
    for (int i = 0; i < 100; ++i) {
        pass(milliseconds(20));
        ASSERT_EQ(sut.current(), before);
    }
}

}  // namespace
}  // namespace atrium::hosts
