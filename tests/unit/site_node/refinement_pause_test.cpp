#include "site_node/refinement_pause.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>

namespace atrium::site_node {
namespace {

using namespace std::chrono_literals;

// A site at 30 metaframes per second that is looked at once a second.
class RefinementPauseTest : public testing::Test {
protected:
    bool look(std::uint64_t num_dropped) {
        now_ += 1s;
        num_captured_ += 30;
        num_dropped_ += num_dropped;
        return pause_.look(now_, num_captured_, num_dropped_);
    }
    // Seconds until something changes, at most 1000.
    int seconds_until_change(std::uint64_t num_dropped) {
        int seconds = 1;
        while (!look(num_dropped) && seconds < 1000) ++seconds;
        return seconds;
    }

    RefinementPause pause_;

private:
    RefinementPause::Clock::time_point now_;
    std::uint64_t num_captured_ = 0;
    std::uint64_t num_dropped_ = 0;
};

TEST_F(RefinementPauseTest, NeverComesWhileFewMetaframesAreDropped) {
    EXPECT_EQ(seconds_until_change(0), 1000);
    EXPECT_EQ(seconds_until_change(2), 1000);
    EXPECT_FALSE(pause_.is_paused());
}

TEST_F(RefinementPauseTest, AMomentWithoutAProcessorIsNoOverload) {
    for (int i = 0; i < 100; ++i) {
        EXPECT_FALSE(look(20));
        EXPECT_FALSE(look(20));
        EXPECT_FALSE(look(1));
    }
}

TEST_F(RefinementPauseTest, BeginsAtTheThirdLookAndLastsTwentySeconds) {
    EXPECT_EQ(seconds_until_change(3), 3);
    EXPECT_TRUE(pause_.is_paused());
    EXPECT_EQ(pause_.duration(), 20s);
    EXPECT_EQ(seconds_until_change(0), 20);
    EXPECT_FALSE(pause_.is_paused());
}

TEST_F(RefinementPauseTest, LastsTwiceAsLongEachTimeThatItEndedTooEarly) {
    for (const int seconds : {20, 40, 80, 160, 320, 320}) {
        EXPECT_EQ(seconds_until_change(15), 3);
        EXPECT_EQ(pause_.duration().count(), seconds);
        EXPECT_EQ(seconds_until_change(0), seconds);
    }
    for (int i = 0; i < 60; ++i) EXPECT_FALSE(look(0));
    EXPECT_EQ(seconds_until_change(15), 3);
    EXPECT_EQ(pause_.duration(), 20s) << "the minute before went well";
}

TEST_F(RefinementPauseTest, GoesOnWhileItDoesNotHelp) {
    EXPECT_EQ(seconds_until_change(15), 3);
    EXPECT_EQ(seconds_until_change(15), 1000);
    EXPECT_TRUE(pause_.is_paused());
    EXPECT_EQ(seconds_until_change(0), 1);
    EXPECT_FALSE(pause_.is_paused());
}

// No pictures come while a camera is unplugged; what was dropped before counts once.
TEST_F(RefinementPauseTest, SilenceIsNoOverload) {
    RefinementPause::Clock::time_point now;
    RefinementPause pause;
    EXPECT_FALSE(pause.look(now, 30, 20));
    for (int i = 0; i < 100; ++i) EXPECT_FALSE(pause.look(now += 1s, 30, 20));
}

}  // namespace
}  // namespace atrium::site_node
