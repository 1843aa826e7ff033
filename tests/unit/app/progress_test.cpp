#include "core/app/progress.hpp"

#include <gtest/gtest.h>

namespace atrium::app {
namespace {

using std::chrono::seconds;

TEST(Progress, TellsPlaceSpeedAndTimeLeft) {
    const Progress::Clock::time_point begin{};
    Progress progress("frame", 54000, seconds(1), begin);
    EXPECT_FALSE(progress.update(5, begin));
    const auto line = progress.update(1200, begin + seconds(109));
    ASSERT_TRUE(line);
    EXPECT_EQ(*line, "frame 1200 of 54000, 11/s, 1 h 20 min left");
    EXPECT_FALSE(progress.update(1201, begin + seconds(109)));
    EXPECT_EQ(*progress.update(54000, begin + seconds(5000)), "frame 54000 of 54000, 11/s");
}

TEST(Progress, SaysNoSpeedBeforeTheFirstPiece) {
    const Progress::Clock::time_point begin{};
    Progress progress("picture", 10, seconds(1), begin);
    EXPECT_EQ(*progress.update(0, begin + seconds(2)), "picture 0 of 10");
    EXPECT_EQ(*progress.update(1, begin + seconds(4)), "picture 1 of 10, 0.2/s, 36 s left");
}

TEST(Progress, WritesDurations) {
    EXPECT_EQ(duration_text(seconds(0)), "0 s");
    EXPECT_EQ(duration_text(seconds(99)), "99 s");
    EXPECT_EQ(duration_text(seconds(720)), "12 min");
    EXPECT_EQ(duration_text(seconds(4790)), "1 h 20 min");
}

}  // namespace
}  // namespace atrium::app
