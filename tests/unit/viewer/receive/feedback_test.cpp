#include "viewer/receive/feedback.hpp"

#include "core/bus/delays_from.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace atrium::viewer {
namespace {

using std::chrono::milliseconds;

constexpr Timestamp kFirstReport{1'000'000'000'000'000'000};

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

TEST_F(FeedbackOfAViewer, IsEmptyWithoutSamples) { EXPECT_TRUE(report(kFirstReport).empty()); }

TEST_F(FeedbackOfAViewer, CountsArrivalsSinceTheLastReport) {
    report(kFirstReport);
    // two frames of two samples each; the clock of the site is an hour ahead
    const auto ahead = std::chrono::hours(1);
    for (const int frame : {0, 1}) {
        const Timestamp captured = kFirstReport + milliseconds(50 * frame) + ahead;
        const Timestamp arrival = kFirstReport + milliseconds(50 * frame + 30 + 5 * frame);
        feedback_.arrived("lab", captured + milliseconds(4), captured, 1000, arrival);
        feedback_.looked(arrival, true);
        feedback_.arrived(
            "lab", captured + milliseconds(5), captured, 3000, arrival + milliseconds(10));
        feedback_.completed(
            "lab", 7u + static_cast<std::uint64_t>(frame), captured, arrival + milliseconds(10));
    }
    feedback_.lost("lab", 2, 3);
    const auto reports = report(kFirstReport + milliseconds(230));
    ASSERT_EQ(reports.size(), 1u);
    const bus::StreamFeedback& first = reports[0];
    EXPECT_EQ(first.viewer, "v1");
    EXPECT_EQ(first.site, "lab");
    EXPECT_EQ(first.newest_frame_id, 8u);
    EXPECT_EQ(first.num_complete, 2u);
    EXPECT_EQ(first.num_incomplete, 2u);
    EXPECT_EQ(first.num_late, 3u);
    EXPECT_EQ(first.num_samples, 4u);
    // counting began with the first sample, 30 ms after the start
    EXPECT_NEAR(first.payload_bytes_per_s, 8000 / 0.2, 1e-6);
    EXPECT_NEAR(first.min_delay_ms, 26.0 - 3.6e6, 1e-6)
        << "the delay must count from the time of writing";
    EXPECT_NEAR(first.median_delay_ms, 45.0 - 3.6e6, 1e-6);

    const auto next = report(kFirstReport + milliseconds(430));
    ASSERT_EQ(next.size(), 1u) << "a silent site must be reported too";
    EXPECT_EQ(next[0].newest_frame_id, 8u);
    EXPECT_EQ(next[0].num_complete + next[0].num_incomplete + next[0].num_late, 0u);
    EXPECT_EQ(next[0].num_samples, 0u);
    EXPECT_EQ(next[0].payload_bytes_per_s, 0.0);
    EXPECT_EQ(next[0].min_delay_ms, 0.0);
    EXPECT_EQ(next[0].sure_delay_ms, 0.0);
    EXPECT_EQ(next[0].median_delay_ms, 0.0);
}

// A recording keeps the capture times of its making.
TEST_F(FeedbackOfAViewer, CountsDelaysOfAPlayedPersonFromThePlaying) {
    const Timestamp captured = kFirstReport + -std::chrono::hours(24 * 365);
    const Timestamp written = kFirstReport + milliseconds(50);
    const Timestamp arrival = written + milliseconds(7);
    feedback_.arrived("lab", written, captured, 1000, arrival);
    feedback_.looked(arrival, true);
    const auto reports = report(kFirstReport + milliseconds(230));
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_NEAR(reports[0].median_delay_ms, 7.0, 1e-6);
    // what comes late from a living site is late
    EXPECT_EQ(bus::delays_from(written + -milliseconds(2900), written).ns,
              (written + -milliseconds(2900)).ns);
    EXPECT_EQ(bus::delays_from(captured, written), written);
    EXPECT_EQ(bus::delays_from(written + std::chrono::hours(1), written), written);
}

/// Frames of one sample each, 33 ms apart, that take 20 ms from writing to this host.
class FeedbackOfALateViewer : public FeedbackOfAViewer {
protected:
    static constexpr int kWay_ms = 20;
    /// Takes samples every 5 ms, but stands still from `stops_ms` to `goes_on_ms`.
    bus::StreamFeedback run(int stops_ms, int goes_on_ms, int queue_ms = 0) {
        std::vector<bus::StreamFeedback> reports;
        int next = 0;
        report(kFirstReport);
        for (int ms = 0; reports.empty(); ms += 5) {
            if (ms >= stops_ms && ms < goes_on_ms) continue;
            const Timestamp now = kFirstReport + milliseconds(ms);
            for (; 33 * next + kWay_ms + queue_ms <= ms; ++next) {
                const Timestamp written = kFirstReport + milliseconds(33 * next);
                feedback_.arrived("lab", written, written, 1000, now);
            }
            feedback_.looked(now, true);
            reports = report(now);
        }
        return reports[0];
    }
};

TEST_F(FeedbackOfALateViewer, IsSureOfTheWholeDelayIfOnTime) {
    const bus::StreamFeedback report = run(0, 0);
    EXPECT_LE(report.longest_wait_ms, 5.0);
    EXPECT_GE(report.min_delay_ms, kWay_ms);
    EXPECT_LE(report.min_delay_ms, kWay_ms + 5);
    EXPECT_EQ(report.sure_delay_ms, report.min_delay_ms);
}

TEST_F(FeedbackOfALateViewer, DoesNotBlameItsOwnWaitOnTheNetwork) {
    const bus::StreamFeedback report = run(5, 200);
    EXPECT_GE(report.longest_wait_ms, 190.0);
    EXPECT_GE(report.num_samples, 5U);
    EXPECT_GT(report.min_delay_ms, kWay_ms) << "even the newest sample had to wait";
    EXPECT_LE(report.sure_delay_ms, kWay_ms);
}

TEST_F(FeedbackOfALateViewer, IsSureOfAQueueLongerThanItsWait) {
    const bus::StreamFeedback report = run(50, 120, 150);
    EXPECT_GE(report.longest_wait_ms, 70.0);
    EXPECT_GE(report.sure_delay_ms, kWay_ms + 150 - 75);
    EXPECT_LE(report.sure_delay_ms, kWay_ms + 150 + 5);
    EXPECT_LE(report.sure_delay_ms, report.min_delay_ms);
}

TEST_F(FeedbackOfALateViewer, DelaysItsReportWhileSamplesWait) {
    feedback_.arrived("lab", kFirstReport, kFirstReport, 1, kFirstReport);
    report(kFirstReport);
    for (int ms = 5; ms < 300; ms += 5) {
        feedback_.looked(kFirstReport + milliseconds(ms), false);
        EXPECT_TRUE(report(kFirstReport + milliseconds(ms)).empty()) << ms;
    }
    feedback_.looked(kFirstReport + milliseconds(300), true);
    EXPECT_EQ(report(kFirstReport + milliseconds(300)).size(), 1U);
    for (int ms = 305; ms < 700; ms += 5) {
        feedback_.looked(kFirstReport + milliseconds(ms), false);
        EXPECT_TRUE(report(kFirstReport + milliseconds(ms)).empty()) << ms;
    }
    feedback_.looked(kFirstReport + milliseconds(700), false);
    EXPECT_EQ(report(kFirstReport + milliseconds(700)).size(), 1U)
        << "the delay of a report is limited";
}

TEST_F(FeedbackOfAViewer, ComesFiveTimesASecond) {
    feedback_.arrived("lab", kFirstReport, kFirstReport, 1, kFirstReport);
    int num_reports = 0;
    for (int ms = 0; ms < 2000; ++ms)
        num_reports += static_cast<int>(report(kFirstReport + milliseconds(ms)).size());
    EXPECT_EQ(num_reports, 10);
}

TEST_F(FeedbackOfAViewer, ContinuesIfTheClockIsSetBack) {
    feedback_.arrived("lab", kFirstReport, kFirstReport, 1, kFirstReport);
    EXPECT_EQ(report(kFirstReport).size(), 1u);
    const Timestamp earlier = kFirstReport + -std::chrono::hours(1);
    EXPECT_EQ(report(earlier).size(), 1u);
    EXPECT_EQ(report(earlier + milliseconds(100)).size(), 0u);
    const auto reports = report(earlier + milliseconds(200));
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_GE(reports[0].payload_bytes_per_s, 0.0);
}

TEST_F(FeedbackOfAViewer, ReportsEachSiteAndForgetsLostOnes) {
    feedback_.arrived("lab", kFirstReport, kFirstReport, 1, kFirstReport);
    feedback_.arrived("hall", kFirstReport, kFirstReport, 1, kFirstReport);
    EXPECT_EQ(report(kFirstReport).size(), 2u);
    EXPECT_TRUE(feedback_.forget("lab"));
    EXPECT_FALSE(feedback_.forget("lab"));
    const auto reports = report(kFirstReport + milliseconds(200));
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_EQ(reports[0].site, "hall");
    for (int i = 0; i < 1000; ++i)
        feedback_.arrived("s" + std::to_string(i), kFirstReport, kFirstReport, 1, kFirstReport);
    EXPECT_EQ(report(kFirstReport + milliseconds(400)).size(), 64u)
        << "the number of sites must be bounded";
}

}  // namespace
}  // namespace atrium::viewer
