#include "site_node/segmentation_worker/worker_tally.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::segmentation_worker {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Tally : public testing::Test {
protected:
    void SetUp() override {
        tally_.look(now_);
        now_ += WorkerTally::kWarmUp;
    }
    // Ten seconds of pictures, of which each nth goes another way.
    template <typename Count>
    std::string finding_of(int num, int every, Count count_bad) {
        tally_.look(now_);
        for (int i = 1; i <= num; ++i) {
            if (i % every == 0)
                count_bad();
            else
                tally_.count_answered();
        }
        now_ += std::chrono::seconds(9);
        tally_.look(now_);
        return tally_.finding();
    }

    WorkerTally tally_{20.0};
    WorkerTally::Clock::time_point now_{};
};

TEST_F(Tally, IsContentWithAHiccup) {
    EXPECT_EQ(finding_of(300, 21, [&] { tally_.count_late(); }), "");
}

TEST_F(Tally, SaysWhatIsWrongAndWhatToDo) {
    tally_.add_latency(std::chrono::milliseconds(31));
    const std::string late = finding_of(300, 4, [&] { tally_.count_late(); });
    EXPECT_THAT(late, StartsWith("the segmentation worker is late for 25 % of the pictures"));
    EXPECT_THAT(late, HasSubstr("median 31 ms, limit 20 ms"));
    EXPECT_THAT(late, HasSubstr("segmentation.worker_deadline_ms"));
    EXPECT_LT(late.size(), 255u);
}

TEST_F(Tally, NamesAnAbsentAndAWrongWorker) {
    EXPECT_THAT(finding_of(100, 1, [&] { tally_.count_absent(); }),
                StartsWith("no segmentation worker for 100 % of the pictures: start it"));
    now_ += WorkerTally::kWindow;
    EXPECT_THAT(finding_of(100, 2, [&] { tally_.count_invalid(); }),
                StartsWith("the segmentation worker gives no valid answer for 50 %"));
}

TEST_F(Tally, ForgetsWhatIsOver) {
    EXPECT_NE(finding_of(100, 1, [&] { tally_.count_absent(); }), "");
    now_ += WorkerTally::kWindow;
    EXPECT_EQ(finding_of(100, 1000, [&] { tally_.count_absent(); }), "");
}

TEST(TallyAtTheStart, LeavesOutTheFirstSeconds) {
    WorkerTally tally(20.0);
    WorkerTally::Clock::time_point now{};
    for (int second = 0; second < 20; ++second) {
        tally.look(now + std::chrono::seconds(second));
        EXPECT_EQ(tally.finding(), "");
        for (int i = 0; i < 30; ++i) {
            if (second < 4)
                tally.count_late();
            else
                tally.count_answered();
        }
    }
}

TEST_F(Tally, DoesNotJudgeFewPictures) {
    EXPECT_EQ(finding_of(19, 1, [&] { tally_.count_absent(); }), "");
}

TEST_F(Tally, ListsItsCounts) {
    tally_.count_answered();
    tally_.count_late();
    tally_.count_late();
    tally_.count_absent();
    EXPECT_EQ(tally_.line(), "answered=1 late=2 invalid=0 absent=1");
    tally_.add_latency(std::chrono::microseconds(8100));
    EXPECT_EQ(tally_.line(), "answered=1 late=2 invalid=0 absent=1 median_ms=8.1 p99_ms=8.1");
}

}  // namespace
}  // namespace atrium::segmentation_worker
