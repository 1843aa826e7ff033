#include "core/bus/dds_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace atrium::bus {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

const DdsLog::Clock::time_point kStart{1000s};

TEST(DdsLog, ReportsAnUnreachablePeerOnceAndThenOncePerMinute) {
    DdsLog log;
    for (int port = 7410; port < 7530; ++port)
        log.add("ddsi_udp_conn_write to udp/10.0.0.7:" + std::to_string(port) +
                " failed with retcode -1\n");
    EXPECT_THAT(log.take(kStart),
                ElementsAre(AllOf(HasSubstr("peer_unreachable address=10.0.0.7 "),
                                  HasSubstr("--interface"),
                                  HasSubstr("times=120"))));
    log.add("ddsi_udp_conn_write to udp/10.0.0.7:7411 failed with retcode -1\n");
    EXPECT_THAT(log.take(kStart + 59s), IsEmpty());
    EXPECT_THAT(log.take(kStart + 60s), ElementsAre(Not(HasSubstr("times="))));
    EXPECT_THAT(log.take(kStart + 200s), IsEmpty()) << "nothing new";
}

TEST(DdsLog, SaysHowLongAgoALateRepetitionWas) {
    DdsLog log;
    const auto refuse = [&log](std::chrono::seconds after) {
        log.add("keys bob", "refused peer=\"bob\"", kStart + after);
    };
    refuse(0s);
    EXPECT_THAT(log.take(kStart + 2s), ElementsAre("refused peer=\"bob\"")) << "not held back";
    for (const auto after : {3s, 10s, 16s}) refuse(after);
    EXPECT_THAT(log.take(kStart + 62s), ElementsAre("refused peer=\"bob\" times=3 ago_s=46"));
    refuse(120s);
    EXPECT_THAT(log.take(kStart + 125s), ElementsAre("refused peer=\"bob\" ago_s=5"));
    refuse(190s);
    EXPECT_THAT(log.take(kStart + 190s), ElementsAre("refused peer=\"bob\"")) << "just now";
}

TEST(DdsLog, TellsPeersAndMessagesApart) {
    DdsLog log;
    log.add("ddsi_udp_conn_write to udp/10.0.0.7:7411 failed with retcode -1");
    log.add("ddsi_udp_conn_write to udp/10.0.0.8:7411 failed with retcode -1");
    log.add("writer 12ab: waiting for 3 readers\n");
    log.add("writer 77: waiting for 4 readers\n");
    EXPECT_THAT(log.take(kStart), SizeIs(3));
}

TEST(DdsLog, KeepsABoundedNumberOfPrintableLines) {
    DdsLog log;
    std::string name;
    for (int i = 0; i < 1000; ++i) log.add("kind " + (name += 'x'));
    EXPECT_THAT(log.take(kStart), SizeIs(65)) << "64 kinds, and one line for the others";
    DdsLog other;
    other.add(std::string(100000, 'y') + "\n\x01");
    const auto lines = other.take(kStart);
    ASSERT_THAT(lines, SizeIs(1));
    EXPECT_LT(lines.front().size(), 400u);
}

TEST(DdsLog, HasRoomAgainForNewKindsWhenOldOnesAreQuiet) {
    DdsLog log;
    std::string name;
    for (int i = 0; i < 100; ++i) log.add("kind " + (name += 'x'));
    log.take(kStart);
    log.take(kStart + 61s);
    log.add("another kind");
    EXPECT_THAT(log.take(kStart + 62s), ElementsAre(HasSubstr("another kind")));
}

TEST(DdsLog, HandsOverWhatItCaptures) {
    DdsLog log;
    log.begin_capture();
    log.add("config: line 3\n");
    log.add("config: line 4\n");
    EXPECT_EQ(log.end_capture(), "config: line 3; config: line 4");
    EXPECT_THAT(log.take(kStart), IsEmpty());
}

}  // namespace
}  // namespace atrium::bus
