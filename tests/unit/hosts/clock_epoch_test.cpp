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
    for (const double rate : {1.0009, 0.9991}) {
        for (int i = 0; i < 300; ++i) {
            pass(milliseconds(i % 3 == 0 ? 5000 : 20), rate);
            ASSERT_EQ(sut.current(), before);
        }
    }
}

// chrony changes the rate by up to 8 %. However often it is looked at, the clock is never further
// away from what was measured of it than kLeastStep.
TEST_F(ClockEpochTest, AClockThatIsSlewedFastIsSetAgainAndAgain) {
    for (const int between_ms : {1, 33, 100}) {
        for (const double rate : {1.08, 0.997, 1.002}) {
            ClockEpoch sut = epoch();
            std::uint64_t number = sut.current();
            double moved_ms = 0.0;  // since the epoch began, beyond the rate that is allowed
            int num_epochs = 0;
            for (int i = 0; i < 3000 / between_ms; ++i) {
                pass(milliseconds(between_ms), rate);
                moved_ms += (std::abs(rate - 1.0) - ClockEpoch::kMostRate) * between_ms;
                const bool is_new = sut.current() != number;
                number = sut.current();
                if (std::abs(moved_ms - 0.8) > 0.005) {  // not where rounding decides
                    ASSERT_EQ(is_new, moved_ms > 0.8) << between_ms << " " << rate << " " << i;
                }
                if (is_new) moved_ms = 0.0;
                num_epochs += is_new ? 1 : 0;
            }
            EXPECT_GT(num_epochs, 2);
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
