#include "tests/integration/site_over_link.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

// A whole site and a viewer over a link with faults, with the options that users would give.
// bench/stream/stream_faults measures more faults. docs/measurements/streams.md has the table.
namespace atrium::test {
namespace {

using namespace std::chrono_literals;
using test_support::comes_true;

class StreamFaults : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  ("atrium_stream_faults_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }
    void SetUp() override { settings_.cache = folder_ / "rooms"; }

    /// Impairs both directions of the link.
    void start_over(const Impairment& impairment) {
        auto network = ImpairedNetwork::create(2, 11);
        if (!network) GTEST_SKIP() << atrium::test::skip::kNoNetwork << network.error().message;
        network_ = std::move(*network);
        for (const int host : {0, 1}) network_->set(host, Way::kUp, impairment);
        start();
    }
    void start() {
        auto run = SiteOverLink::start(network_.get(), settings_);
        ASSERT_TRUE(run) << run.error().message;
        run_ = std::move(*run);
        std::this_thread::sleep_for(1s);  // the measurement begins after the start
        from_ = run_->moment();
    }
    /// Frames complete in order: once a later one is complete, no frame of the report is on its
    /// way.
    SiteReport finish() {
        const Moment to = run_->moment();
        EXPECT_TRUE(run_->wait_for_frame_after(to.now_ns));
        auto report = run_->finish(from_, to);
        if (!report) {
            ADD_FAILURE() << report.error().message;
            return {};
        }
        std::printf("%zu of %zu frames, age p50 %.0f ms, p99 %.0f ms, %.0f kB/s, %.1f to %.1f MB\n",
                    report->num_complete,
                    report->num_published,
                    report->age_ms(0.5),
                    report->age_ms(0.99),
                    1e-3 * report->bytes_per_s,
                    1e-6 * static_cast<double>(report->resident_before),
                    1e-6 * static_cast<double>(report->resident_after));
        EXPECT_GT(report->num_published, 0U);
        EXPECT_EQ(report->num_out_of_order, 0U) << report->out_of_order;
        EXPECT_LT(report->resident_after, report->resident_before + 20'000'000);
        return std::move(*report);
    }

    static inline std::filesystem::path folder_;
    SiteSettings settings_;
    std::unique_ptr<ImpairedNetwork> network_;
    std::unique_ptr<SiteOverLink> run_;
    Moment from_;
};

TEST_F(StreamFaults, LosesNoFrameAtOnePercentLossOnAShortLink) {
    start_over({.delay = 2ms, .loss = 0.01});
    if (run_ == nullptr) return;
    const std::uint64_t before = network_->counters(0, Way::kUp).lost;
    ASSERT_TRUE(comes_true([&] { return network_->counters(0, Way::kUp).lost > before + 20; }));
    const SiteReport report = finish();
    EXPECT_EQ(report.num_complete, report.num_published);
}

// Cyclone itself loses packets on purpose, with the settings for programs of one host.
TEST_F(StreamFaults, RepairsLossesOfCycloneOnLoopback) {
    std::ifstream builtin(atrium::test::source_dir() + "/qos/loopback.xml");
    std::string xml(std::istreambuf_iterator<char>(builtin), {});
    const std::size_t at = xml.find("<Internal>");
    ASSERT_NE(at, std::string::npos);
    xml.insert(at + 10, "<Test><XmitLossiness>10</XmitLossiness></Test>");  // per thousand
    const std::filesystem::path file = folder_ / "lossy.xml";
    std::ofstream(file) << xml;
    settings_.bus_options = {
        "--network", file.string(), "--bus.world", "stream-faults", "--bus.domain", "191"};
    start();
    if (run_ == nullptr) return;
    std::this_thread::sleep_for(4s);
    const SiteReport report = finish();
    EXPECT_EQ(report.num_complete, report.num_published);
}

TEST_F(StreamFaults, DeliversTheNewestAndNothingOldAfterACut) {
    start_over({.delay = 10ms});
    if (run_ == nullptr) return;
    std::this_thread::sleep_for(1s);
    network_->cut(1);
    std::this_thread::sleep_for(3s);
    network_->restore(1);
    const Moment restored = run_->moment();
    ASSERT_TRUE(run_->wait_for_frame_after(restored.now_ns));
    const SiteReport report = finish();
    for (const ShownFrame& frame : report.shown) {
        if (frame.complete_ns <= restored.now_ns) continue;
        // twice the lifespan, and the site's own work
        EXPECT_LT(frame.age_ms(), 1200.0) << "the frame waited for too long";
    }
    std::printf("back after %.0f ms\n", report.recovery_ms(restored.now_ns));
    EXPECT_LT(report.recovery_ms(restored.now_ns), 2000.0);
}

TEST_F(StreamFaults, StoppedViewerDoesNotSlowTheSite) {
    start_over({.delay = 10ms});
    if (run_ == nullptr) return;
    std::this_thread::sleep_for(3s);
    run_->viewer().signal(SIGSTOP);
    const Moment stopped = run_->moment();
    std::this_thread::sleep_for(5s);
    run_->viewer().signal(SIGCONT);
    const Moment woken = run_->moment();
    ASSERT_TRUE(run_->wait_for_frame_after(woken.now_ns));
    const std::int64_t begin_ns = from_.now_ns;
    from_ = stopped;
    const SiteReport report = finish();
    // Other programs change the rate by a third. A write that waits for the reader takes 50 ms, the
    // nine of a frame leave a fifteenth of it.
    EXPECT_GT(report.published_per_s(stopped.now_ns, woken.now_ns),
              0.5 * report.published_per_s(begin_ns, stopped.now_ns));
    EXPECT_EQ(report.output_of_site.find("not published"), std::string::npos);
    std::printf("back after %.0f ms\n", report.recovery_ms(woken.now_ns));
    EXPECT_LT(report.recovery_ms(woken.now_ns), 2000.0);
}

TEST_F(StreamFaults, SiteSendsLessOverANarrowLink) {
    start_over({.delay = 20ms, .rate_bit_per_s = 5e6});
    if (run_ == nullptr) return;
    std::this_thread::sleep_for(6s);
    from_ = run_->moment();
    std::this_thread::sleep_for(5s);
    const SiteReport report = finish();
    EXPECT_THAT(report.output_of_site, testing::HasSubstr("stream level quality="));
    EXPECT_LT(report.bytes_per_s, 0.65e6);
    // the link delay, the site's own work, and a full queue of 100 ms
    EXPECT_LT(report.age_ms(0.5), 250.0);
}

}  // namespace
}  // namespace atrium::test
