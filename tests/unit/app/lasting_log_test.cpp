#include "core/app/lasting_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::app::log {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

const LastingLog::Time kBegin{100s};

// The tenths of seconds of the lines of a state that comes ten times a second.
std::vector<int> lines_of(LastingLog& log, const char* state, int from, int to) {
    std::vector<int> lines;
    for (int i = from; i < to; ++i) {
        if (log.next(state, "line", kBegin + i * 100ms)) lines.push_back(i);
    }
    return lines;
}

TEST(LastingLog, SaysAStateMoreAndMoreSeldom) {
    LastingLog log;
    EXPECT_THAT(lines_of(log, "a", 0, 4000),
                ElementsAre(0, 10, 30, 70, 150, 310, 630, 1270, 2550, 3830));
}

TEST(LastingLog, SaysAnotherStateAtOnceAndOneThatIsBack) {
    LastingLog log;
    EXPECT_THAT(lines_of(log, "a", 0, 100), ElementsAre(0, 10, 30, 70));
    EXPECT_THAT(lines_of(log, "b", 100, 125), ElementsAre(100, 110));
    EXPECT_THAT(lines_of(log, "b", 180, 195), ElementsAre(180, 190));
}

TEST(LastingLog, SaysOneLineASecondOfStatesThatAlternate) {
    LastingLog log;
    int num_lines = 0;
    for (int i = 0; i < 1000; ++i)
        num_lines += log.next(i % 2 == 0 ? "a" : "b", "line", kBegin + i * 100ms).has_value();
    EXPECT_EQ(num_lines, 100);
}

TEST(LastingLog, CountsWhatItHoldsBack) {
    LastingLog log;
    EXPECT_EQ(log.next("a", "one", kBegin), "one");
    EXPECT_EQ(log.next("a", "two", kBegin + 300ms), std::nullopt);
    EXPECT_EQ(log.next("a", "three", kBegin + 600ms), std::nullopt);
    EXPECT_EQ(log.next("a", "four", kBegin + 1s), "four held_back=2");
}

}  // namespace
}  // namespace atrium::app::log
