#include "viewer/feedback.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace atrium::viewer {
namespace {

using std::chrono::milliseconds;

constexpr Timestamp kStart{1'000'000'000'000'000'000};

class FeedbackOfAViewer : public testing::Test {
protected:
    std::vector<bus::StreamFeedback> report(Timestamp now) {
        std::vector<bus::StreamFeedback> reports;
        feedback_.report(
            "v1", now, [&](const bus::StreamFeedback& one) { reports.push_back(one); });
        return reports;
    }
    Feedback feedback_;
};

TEST_F(FeedbackOfAViewer, IsNothingWhereNothingCame) { EXPECT_TRUE(report(kStart).empty()); }

TEST_F(FeedbackOfAViewer, CountsWhatArrivedSinceTheLastOne) {
    report(kStart);
    // two frames of two samples each; the clock of the site is an hour ahead
    const auto ahead = std::chrono::hours(1);
    for (const int frame : {0, 1}) {
        const Timestamp captured = kStart + milliseconds(50 * frame) + ahead;
        const Timestamp arrival = kStart + milliseconds(50 * frame + 30 + 5 * frame);
        feedback_.arrived("lab", captured, 1000, arrival);
        feedback_.arrived("lab", captured, 3000, arrival + milliseconds(10));
        feedback_.completed(
            "lab", 7u + static_cast<std::uint64_t>(frame), captured, arrival + milliseconds(10));
    }
    feedback_.lost("lab", 2, 3);
    const auto reports = report(kStart + milliseconds(230));
    ASSERT_EQ(reports.size(), 1u);
    const bus::StreamFeedback& first = reports[0];
    EXPECT_EQ(first.viewer, "v1");
    EXPECT_EQ(first.site, "lab");
    EXPECT_EQ(first.newest_frame_id, 8u);
    EXPECT_EQ(first.num_complete, 2u);
    EXPECT_EQ(first.num_incomplete, 2u);
    EXPECT_EQ(first.num_late, 3u);
    EXPECT_EQ(first.num_samples, 4u);
    // it began to count when the first sample came, 30 ms after the start
    EXPECT_NEAR(first.payload_bytes_per_s, 8000 / 0.2, 1e-6);
    EXPECT_NEAR(first.min_delay_ms, 30.0 - 3.6e6, 1e-6);
    EXPECT_NEAR(first.median_delay_ms, 45.0 - 3.6e6, 1e-6);

    const auto next = report(kStart + milliseconds(430));
    ASSERT_EQ(next.size(), 1u) << "a site from which nothing comes is reported all the same";
    EXPECT_EQ(next[0].newest_frame_id, 8u);
    EXPECT_EQ(next[0].num_complete + next[0].num_incomplete + next[0].num_late, 0u);
    EXPECT_EQ(next[0].num_samples, 0u);
    EXPECT_EQ(next[0].payload_bytes_per_s, 0.0);
    EXPECT_EQ(next[0].min_delay_ms, 0.0);
    EXPECT_EQ(next[0].median_delay_ms, 0.0);
}

TEST_F(FeedbackOfAViewer, ComesFiveTimesASecond) {
    feedback_.arrived("lab", kStart, 1, kStart);
    int num_reports = 0;
    for (int ms = 0; ms < 2000; ++ms)
        num_reports += static_cast<int>(report(kStart + milliseconds(ms)).size());
    EXPECT_EQ(num_reports, 10);
}

TEST_F(FeedbackOfAViewer, GoesOnWhereTheClockIsSetBack) {
    feedback_.arrived("lab", kStart, 1, kStart);
    EXPECT_EQ(report(kStart).size(), 1u);
    const Timestamp earlier = kStart + -std::chrono::hours(1);
    EXPECT_EQ(report(earlier).size(), 1u);
    EXPECT_EQ(report(earlier + milliseconds(100)).size(), 0u);
    const auto reports = report(earlier + milliseconds(200));
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_GE(reports[0].payload_bytes_per_s, 0.0);
}

TEST_F(FeedbackOfAViewer, HasOneForEachSiteAndForgetsThoseThatAreGone) {
    feedback_.arrived("lab", kStart, 1, kStart);
    feedback_.arrived("hall", kStart, 1, kStart);
    EXPECT_EQ(report(kStart).size(), 2u);
    EXPECT_TRUE(feedback_.forget("lab"));
    EXPECT_FALSE(feedback_.forget("lab"));
    const auto reports = report(kStart + milliseconds(200));
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_EQ(reports[0].site, "hall");
    for (int i = 0; i < 1000; ++i) feedback_.arrived("s" + std::to_string(i), kStart, 1, kStart);
    EXPECT_EQ(report(kStart + milliseconds(400)).size(), 64u) << "a flood of sites";
}

}  // namespace
}  // namespace atrium::viewer
