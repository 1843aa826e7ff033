#include "tests/unit/tunnel/recorded_commands.hpp"
#include "tools/tunnel/tunnel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace atrium::tunnel_tool {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kCard;
using testing::kPrivateKey;
using ::testing::Not;
using testing::RecordedCommands;
using testing::tunnel_of;

constexpr Timestamp kNow{1'800'000'000'000'000'000};

class TunnelStatus : public ::testing::Test {
protected:
    // The lines of the table as words with one space between them, without head lines.
    std::vector<std::string> rows(const std::string& name, const std::string& peers) {
        host_.answer(
            "wg show",
            0,
            kPrivateKey + "\t" + tunnel_of(name).own().public_key + "\t4711\toff\n" + peers);
        const auto text = describe(tunnel_of(name), kCard, kNow, host_.run());
        if (!text) return {text.error().message};
        EXPECT_THAT(*text, Not(HasSubstr(kPrivateKey)));
        std::istringstream stream(*text);
        std::vector<std::string> lines;
        for (std::string line; std::getline(stream, line);) {
            std::istringstream words(line);
            std::string row;
            for (std::string word; words >> word;) row += (row.empty() ? "" : " ") + word;
            lines.push_back(row);
        }
        EXPECT_EQ(lines.size() >= 2 ? lines[1] : "",
                  "place address seen at handshake in [kB] out [kB]");
        head_ = lines.front();
        lines.erase(lines.begin(), lines.begin() + 2);
        return lines;
    }

    RecordedCommands host_;
    std::string head_;
};

TEST_F(TunnelStatus, ShowsTheSpokesToTheHub) {
    EXPECT_THAT(rows("hall",
                     "AgAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=\t(none)\t203.0.113.9:40001\t"
                     "10.200.7.2/32\t1799999990\t123456\t7890123\toff\n"
                     "AwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=\t(none)\t(none)\t"
                     "10.200.7.3/32\t0\t0\t148\toff\n"),
                ElementsAre("bob 10.200.7.2 203.0.113.9:40001 10 s ago 123 7890",
                            "alice 10.200.7.3 - never 0 0"));
    EXPECT_EQ(head_, "wg-playroom: 10.200.7.1 of hall, hub studio.example.org:4711");
    EXPECT_THAT(host_.lines, ElementsAre("wg show wg-playroom dump"));
}

TEST_F(TunnelStatus, ShowsTheHubToASpoke) {
    EXPECT_THAT(rows("bob",
                     "AQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=\t(none)\t198.51.100.1:4711\t"
                     "10.200.7.0/24\t1800000003\t1000\t2000\t25\n"),
                ElementsAre("hall 10.200.7.1 198.51.100.1:4711 0 s ago 1 2",
                            "alice 10.200.7.3 through the hub"));
    EXPECT_EQ(head_, "wg-playroom: 10.200.7.2 of bob, hub studio.example.org:4711");
}

TEST_F(TunnelStatus, NamesThePlacesThatTheHubDoesNotKnowYet) {
    EXPECT_THAT(rows("hall", "damaged line\n"),
                ElementsAre("bob 10.200.7.2 not configured: run `atrium tunnel up`",
                            "alice 10.200.7.3 not configured: run `atrium tunnel up`"));
}

TEST_F(TunnelStatus, NamesThosePeersThatAreNotInTheFileAnyMore) {
    EXPECT_THAT(rows("bob",
                     "AQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=\t(none)\t198.51.100.1:4711\t"
                     "10.200.7.0/24\t1800000003\t1000\t2000\t25\n"
                     "BQAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=\t(none)\t203.0.113.9:40001\t"
                     "10.200.7.9/32\t1799999990\t123456\t7890123\toff\n"),
                ElementsAre("hall 10.200.7.1 198.51.100.1:4711 0 s ago 1 2",
                            "alice 10.200.7.3 through the hub",
                            "? 10.200.7.9 not in this file (revoked, or renewed): run `atrium "
                            "tunnel up`"));
}

TEST_F(TunnelStatus, RefusesACardWithTheKeysOfAnotherPlace) {
    host_.answer(
        "wg show", 0, kPrivateKey + "\t" + tunnel_of("alice").own().public_key + "\t1\toff\n");
    const auto text = describe(tunnel_of("bob"), kCard, kNow, host_.run());
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(text.error().message, HasSubstr("other keys than those of bob"));
}

TEST_F(TunnelStatus, SaysHowToBringATunnelUpThatIsNot) {
    for (const int exit_code : {1, kNoSuchProgram}) {
        host_.answer("wg show", exit_code, "Unable to access interface: No such device\n");
        const auto text = describe(tunnel_of("bob"), kCard, kNow, host_.run());
        ASSERT_FALSE(text);
        EXPECT_EQ(text.error().kind, ErrorKind::kUnavailable);
        EXPECT_THAT(text.error().message,
                    AllOf(HasSubstr("the tunnel wg-playroom is not up"),
                          HasSubstr("sudo atrium tunnel up FILE")));
    }
}

}  // namespace
}  // namespace atrium::tunnel_tool
