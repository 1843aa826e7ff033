#include "core/bus/network_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::bus {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

NetworkSettings load(const std::string& network,
                     const std::string& peers = "",
                     const std::string& interface = "") {
    BusOptions options;
    options.network = network;
    options.peers = peers;
    options.interface = interface;
    const auto settings = load_network_settings(options);
    EXPECT_TRUE(settings) << (settings ? "" : settings.error().message);
    return settings ? *settings : NetworkSettings{};
}

Error error_of(const BusOptions& options) {
    const auto settings = load_network_settings(options);
    return settings ? Error{ErrorKind::kInternal, "no error"} : settings.error();
}

TEST(Network, DoesNotFragmentDatagramsOfWifiAndWan) {
    EXPECT_THAT(load("wifi").xml,
                AllOf(HasSubstr("<MaxMessageSize>1400B</MaxMessageSize>"),
                      HasSubstr("<FragmentSize>1300B</FragmentSize>")));
    // with keys, in a tunnel
    EXPECT_THAT(load("wan").xml,
                AllOf(HasSubstr("<MaxMessageSize>1200B</MaxMessageSize>"),
                      HasSubstr("<FragmentSize>1000B</FragmentSize>")));
}

TEST(Network, UsesMulticastOnWifiAndLanOnly) {
    EXPECT_FALSE(load("wan").multicast);
    EXPECT_FALSE(load("loopback").multicast);
    EXPECT_TRUE(load("wifi").multicast);
    EXPECT_TRUE(load("lan").multicast);
    EXPECT_THAT(load("wan").xml, Not(HasSubstr("spdp")));
}

TEST(Network, HasRoomForItsProgramsOfEveryKind) {
    for (const char* kind : {"loopback", "lan", "wifi"}) {
        EXPECT_THAT(load(kind).xml, HasSubstr("<MaxAutoParticipantIndex>119<")) << kind;
    }
}

TEST(Network, WritesPeersAndInterfaceIntoTheFile) {
    const NetworkSettings wan = load("wan", "192.0.2.10, 192.0.2.20", "lo");
    EXPECT_THAT(wan.xml,
                AllOf(HasSubstr("<Peer Address=\"192.0.2.10\"/>"),
                      HasSubstr("<Peer Address=\"192.0.2.20\"/>"),
                      HasSubstr("<NetworkInterface name=\"lo\"/>")));
    EXPECT_EQ(wan.card, "lo");
    EXPECT_EQ(wan.address, "127.0.0.1");
    EXPECT_TRUE(wan.has_remote_peers);
    EXPECT_THAT(wan.peers, Contains("127.0.0.1")) << "the programs of this host must be peers";
    const NetworkSettings here = load("lan", "localhost");
    EXPECT_THAT(here.peers, Contains("127.0.0.1"));
    EXPECT_FALSE(here.has_remote_peers);
    // the attribute that disables multicast on lo stays
    EXPECT_THAT(load("loopback", "", "lo").xml, HasSubstr("multicast=\"false\""));
}

TEST(Network, NamesAnUnknownPeerInterfaceOrFile) {
    BusOptions options;
    options.peers = "no-such-host.invalid";
    EXPECT_EQ(error_of(options).kind, ErrorKind::kConfiguration);
    EXPECT_THAT(error_of(options).message, HasSubstr("'no-such-host.invalid'"));
    options = {};
    options.interface = "atrium9";
    EXPECT_EQ(error_of(options).kind, ErrorKind::kConfiguration);
    EXPECT_THAT(error_of(options).message, AllOf(HasSubstr("'atrium9'"), HasSubstr("lo")));
    options = {};
    options.network = "/nowhere/wifi.xml";
    EXPECT_EQ(error_of(options).kind, ErrorKind::kNotFound);
    EXPECT_THAT(error_of(options).message, HasSubstr("/nowhere/wifi.xml"));
}

TEST(Network, LeavesOutPeersThatLoopbackCannotReach) {
    const NetworkSettings settings = load("loopback", "192.0.2.10,127.0.0.1");
    EXPECT_THAT(settings.peers, Not(Contains("192.0.2.10")));
    EXPECT_THAT(report_network(settings).warnings,
                Contains(AllOf(HasSubstr("192.0.2.10"), HasSubstr("--network lan"))));
}

TEST(Network, IsReportedInOneLineWithItsProblems) {
    NetworkSettings settings = load("wan", "192.0.2.10", "lo");
    settings.receive_buffer_bytes = 4096;
    const NetworkReport report = report_network(settings);
    EXPECT_THAT(report.line,
                AllOf(HasSubstr("kind=wan"),
                      HasSubstr("interface=lo"),
                      HasSubstr("address=127.0.0.1"),
                      HasSubstr("unicast peers=192.0.2.10"),
                      HasSubstr("receive_buffer_kB=4")));
    EXPECT_THAT(report.line, Not(HasSubstr("\n")));
    EXPECT_THAT(report.warnings, Contains(HasSubstr("sysctl -w net.core.rmem_max=16777216")));
    EXPECT_THAT(report.warnings, Contains(HasSubstr("--interface")));
    EXPECT_THAT(report_network(load("loopback", "192.0.2.10")).warnings,
                Contains(HasSubstr("reaches only this one")));
    EXPECT_THAT(report_network(load("loopback")).warnings, Each(HasSubstr("rmem_max")));
    EXPECT_THAT(report_network(load("wan")).warnings, Contains(HasSubstr("--peers")));
}

}  // namespace
}  // namespace atrium::bus
