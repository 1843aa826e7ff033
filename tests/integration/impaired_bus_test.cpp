#include "tests/integration/stream_over_link.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <thread>

// The bus on bad links, with frames of a site's size, between programs that know each other by
// address. docs/measurements/links.md has the measurements behind the settings.
namespace atrium::test {
namespace {

using namespace std::chrono_literals;

constexpr int kOneSecond = 30;               // samples per key
constexpr std::uint64_t kFiveSeconds = 150;  // frames
constexpr const char* kFastRepair =
    "<NackDelay>2ms</NackDelay>"
    "<HeartbeatInterval min=\"1ms\" minsched=\"2ms\" max=\"1s\">5ms</HeartbeatInterval>"
    "<MaxQueuedRexmitBytes>1MB</MaxQueuedRexmitBytes>"
    "<DefragReliableMaxSamples>256</DefragReliableMaxSamples>";

// The profiles of meshes and textures with other history depths, and with samples that no delay of
// a busy machine can let expire.
void write_profiles(int writer_depth, int reader_depth, const std::filesystem::path& file) {
    std::ifstream stream(atrium::test::source_dir() + "/qos/profiles.xml");
    std::string all(std::istreambuf_iterator<char>(stream), {});
    all = std::regex_replace(all, std::regex("<lifespan>.*</lifespan>"), "");
    const auto deepen = [&](const std::string& profile, const char* endpoint, int depth) {
        const std::size_t begin =
            all.find(endpoint, all.find("<qos_profile name=\"" + profile + "\">"));
        for (const char* element : {"<depth>", "<max_samples_per_instance>"}) {
            const std::size_t at = all.find(std::string(element) + "8<", begin);
            ASSERT_NE(at, std::string::npos);
            all.replace(at + std::strlen(element), 1, std::to_string(depth));
        }
    };
    for (const char* profile : {"stream", "texture"}) {
        deepen(profile, "<datawriter_qos>", writer_depth);
        deepen(profile, "<datareader_qos>", reader_depth);
    }
    std::ofstream(file) << all;
}

class ImpairedBus : public testing::Test {
protected:
    void SetUp() override {
        auto network = ImpairedNetwork::create(2, 7);
        if (!network) GTEST_SKIP() << atrium::test::skip::kNoNetwork << network.error().message;
        network_ = std::move(*network);
        settings_.network_file =
            testing::TempDir() + "impaired_bus_" + std::to_string(getpid()) + ".xml";
        std::ofstream(settings_.network_file) << network_xml(*network_, kFastRepair);
    }
    void TearDown() override {
        std::filesystem::remove(settings_.network_file);
        std::filesystem::remove(settings_.profiles_file);
    }

    void use_history(int writer_depth, int reader_depth) {
        settings_.profiles_file =
            testing::TempDir() + "impaired_bus_profiles_" + std::to_string(getpid()) + ".xml";
        write_profiles(writer_depth, reader_depth, settings_.profiles_file);
    }

    void impair_both_ways(const Impairment& impairment) {
        for (const int host : {0, 1}) network_->set(host, Way::kUp, impairment);
    }
    std::unique_ptr<StreamOverLink> start() {
        auto stream = StreamOverLink::start(*network_, settings_);
        EXPECT_TRUE(stream) << (stream ? "" : stream.error().message);
        return stream ? std::move(*stream) : nullptr;
    }
    StreamReport finish(StreamOverLink& stream, const char* name) {
        const auto report = stream.finish();
        if (!report) {
            ADD_FAILURE() << report.error().message;
            return {};
        }
        std::printf("%s\n%s\n",
                    table_head().c_str(),
                    table_row(name, *report, settings_.num_frames).c_str());
        EXPECT_EQ(report->write_ms.size(), settings_.num_frames);
        EXPECT_EQ(report->num_failed_writes, 0u);
        EXPECT_EQ(report->num_out_of_order, 0u);
        return *report;
    }

    std::unique_ptr<ImpairedNetwork> network_;
    StreamSettings settings_;
};

TEST_F(ImpairedBus, GoodLinkDeliversEachFrame) {
    impair_both_ways({.delay = 50ms, .jitter = 10ms});
    settings_.num_frames = 90;
    use_history(1, kOneSecond);  // a busy machine may delay the reader
    const auto stream = start();
    ASSERT_TRUE(stream);
    const StreamReport report = finish(*stream, "50 +- 10 ms");
    EXPECT_EQ(report.complete.size(), settings_.num_frames);
    EXPECT_EQ(report.retransmitted_bytes, 0u);
    EXPECT_GE(report.age_ms(0.0), 40.0);
}

// A repair takes slightly more than a round trip, which is shorter here than the time between two
// frames. On a longer link only a longer history still has the frame, as the next test shows.
TEST_F(ImpairedBus, RepairsFramesAtOnePercentLossOnAShortLink) {
    impair_both_ways({.delay = 2ms, .loss = 0.01});
    use_history(1, kOneSecond);
    settings_.num_frames = kFiveSeconds;
    const auto stream = start();
    ASSERT_TRUE(stream);
    const StreamReport report = finish(*stream, "2 ms, 1 % lost");
    EXPECT_GT(report.there.lost, 50u);
    EXPECT_GT(report.retransmitted_bytes, 50u * 1000);
    // A writer with history 1 may skip a frame: a repair can be lost as well, or be late on a busy
    // machine. Without repair 47 % of the frames were lost.
    EXPECT_GE(report.share_complete(), 0.9);
    EXPECT_LT(report.longest_gap_ms(), 500.0);
}

TEST_F(ImpairedBus, HistoryAndAWriterPerCameraLoseNoFrameOnALongLink) {
    impair_both_ways({.delay = 50ms, .jitter = 10ms, .loss = 0.01});
    use_history(kOneSecond, kOneSecond);
    settings_.num_frames = kFiveSeconds;
    settings_.mesh_bytes = 12'000;
    settings_.texture_bytes = 4'000;
    settings_.num_texture_writers = 8;
    const auto stream = start();
    ASSERT_TRUE(stream);
    const StreamReport report = finish(*stream, "50 +- 10 ms, 1 % lost, history");
    EXPECT_GT(report.there.lost, 50u);
    EXPECT_EQ(report.complete.size(), settings_.num_frames);
    EXPECT_LT(report.age_ms(0.5), 200.0);
}

TEST_F(ImpairedBus, NewestFrameArrivesAtOnceAfterACutOfThreeSeconds) {
    impair_both_ways({.delay = 10ms});
    settings_.num_frames = 7 * kOneSecond;
    const auto stream = start();
    ASSERT_TRUE(stream);
    std::this_thread::sleep_for(1s);
    network_->cut(1);
    std::this_thread::sleep_for(3s);
    network_->restore(1);
    const std::int64_t restored_ns =
        std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
    const StreamReport report = finish(*stream, "cut for 3 s");
    EXPECT_GT(report.longest_gap_ms(), 2500.0);
    std::int64_t first_ns = 0;
    for (const CompleteFrame& frame : report.complete) {
        if (frame.complete_ns <= restored_ns) continue;
        if (first_ns == 0) first_ns = frame.complete_ns;
        // no frame that waited during the cut
        EXPECT_GT(frame.capture_ns, restored_ns - 1'000'000'000);
    }
    ASSERT_GT(first_ns, 0) << "no frame arrived after the cut";
    const double recovery_ms = static_cast<double>(first_ns - restored_ns) * 1e-6;
    std::printf("back %.0f ms after the link\n", recovery_ms);
    EXPECT_LT(recovery_ms, 2000.0);
    EXPECT_EQ(report.complete.back().number, settings_.num_frames);
}

TEST_F(ImpairedBus, StoppedReaderDoesNotSlowWritesDown) {
    impair_both_ways({.delay = 10ms});
    settings_.num_frames = 8 * kOneSecond;
    const auto stream = start();
    ASSERT_TRUE(stream);
    std::this_thread::sleep_for(1s);
    stream->reader().signal(SIGSTOP);
    std::this_thread::sleep_for(5s);
    stream->reader().signal(SIGCONT);
    const StreamReport report = finish(*stream, "reader stopped for 5 s");
    EXPECT_GT(report.longest_gap_ms(), 4500.0);
    // a write that waits for the reader takes 50 ms or fails; other writes take less than one
    EXPECT_LT(report.write_ms_at(0.95), 10.0);
    EXPECT_EQ(report.complete.back().number, settings_.num_frames);
}

}  // namespace
}  // namespace atrium::test
