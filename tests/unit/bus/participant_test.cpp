#include "core/bus/bus.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/unit/bus/bus_support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

namespace atrium::bus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::own_world;
using testing::value;

class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& text)
        : path_(std::filesystem::temp_directory_path() /
                ("atrium-bus-" + std::to_string(::getpid()) + ".xml")) {
        std::ofstream(path_) << text;
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() { std::filesystem::remove(path_); }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

Error error_of(const BusOptions& options) {
    const auto participant = Participant::create(options);
    return participant ? Error{ErrorKind::kInternal, "no error"} : participant.error();
}

TEST(Participant, SaysThatLoopbackIsThisHostOnly) {
    const BusOptions options = own_world("place");
    const auto participant = value(Participant::create(options));
    EXPECT_EQ(participant.place(),
              "world=" + options.world +
                  " domain=101 network=loopback (this host only: --network lan for others)");
}

TEST(Participant, NamesBadOptions) {
    BusOptions options = own_world("options");
    options.world = "*";
    EXPECT_THAT(error_of(options).message, HasSubstr("world '*'"));
    options = own_world("options", 231);
    EXPECT_THAT(error_of(options).message, HasSubstr("0..230"));
    options = own_world("options");
    options.network = "/nowhere/lan.xml";
    EXPECT_EQ(error_of(options).kind, ErrorKind::kNotFound);
    EXPECT_THAT(error_of(options).message, HasSubstr("/nowhere/lan.xml"));
    options = own_world("options");
    options.profiles_file = "/nowhere/profiles.xml";
    EXPECT_EQ(error_of(options).kind, ErrorKind::kNotFound);
    const TemporaryFile empty("<dds/>");
    options.profiles_file = empty.path();
    EXPECT_THAT(error_of(options).message, HasSubstr("the profile 'description' is missing"));
}

TEST(Participant, ReportsCyclonesErrorsInANetworkFileWithTheLine) {
    BusOptions options = own_world("network", 103);
    const TemporaryFile file(
        "<?xml version='1.0'?>\n<!-- of\n  two lines -->\n<CycloneDDS>\n  <Domain Id='any'>\n"
        "    <General><AllowMulticast>\n      false\n    </AllowMulticast>\n"
        "      <Interfaces><NetworkInterface\n        name='lo'/></Interfaces></General>\n"
        "    <!-- <Tracing> -->\n    <Internal>\n      <Nonsense>1</Nonsense></Internal>\n"
        "  </Domain>\n</CycloneDDS>\n");
    for (const std::string peers : {"", "127.0.0.1"}) {
        options.network = file.path().string();
        options.peers = peers;  // changes the configuration that Cyclone gets
        EXPECT_EQ(error_of(options).kind, ErrorKind::kConfiguration);
        EXPECT_THAT(error_of(options).message,
                    AllOf(HasSubstr(file.path().string()),
                          HasSubstr("Nonsense"),
                          HasSubstr("(line 13)"),
                          Not(HasSubstr("CYCLONEDDS_URI"))));
    }
}

TEST(Participant, NamesAMissingInterface) {
    BusOptions options = own_world("interface", 104);
    const TemporaryFile file(
        "<CycloneDDS><Domain Id='any'><General><Interfaces><NetworkInterface name='atrium9'/>"
        "</Interfaces></General></Domain></CycloneDDS>");
    options.network = file.path().string();
    EXPECT_EQ(error_of(options).kind, ErrorKind::kConfiguration);
    EXPECT_THAT(error_of(options).message, AllOf(HasSubstr("atrium9"), HasSubstr("available: ")));
}

TEST(Participant, RefusesSettingsForAnotherDomain) {
    BusOptions options = own_world("other-domain", 104);
    const TemporaryFile file("<CycloneDDS><Domain Id='3'><General/></Domain></CycloneDDS>");
    options.network = file.path().string();
    EXPECT_EQ(error_of(options).kind, ErrorKind::kConfiguration);
    EXPECT_THAT(error_of(options).message,
                AllOf(HasSubstr("Id=\"3\""), HasSubstr("domain 104"), HasSubstr("--bus.domain 3")));
}

/// Occupies a UDP port.
class OccupiedPort {
public:
    explicit OccupiedPort(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        is_mine_ = ::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
    }
    OccupiedPort(const OccupiedPort&) = delete;
    OccupiedPort& operator=(const OccupiedPort&) = delete;
    ~OccupiedPort() { ::close(socket_); }
    bool is_mine() const { return is_mine_; }

private:
    int socket_;
    bool is_mine_ = false;
};

TEST(Participant, GivesAdviceIfItsPortsAreTaken) {
    BusOptions options = own_world("ports", 107);
    const TemporaryFile file(
        "<CycloneDDS><Domain Id='any'><Discovery><ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>0</MaxAutoParticipantIndex></Discovery></Domain></CycloneDDS>");
    options.network = file.path().string();
    const OccupiedPort taken(7400 + 250 * 107 + 10);  // the port of the first process in the domain
    ASSERT_TRUE(taken.is_mine());
    EXPECT_EQ(error_of(options).kind, ErrorKind::kUnavailable);
    EXPECT_THAT(error_of(options).message,
                AllOf(HasSubstr("domain 107"), HasSubstr("MaxAutoParticipantIndex")));
}

TEST(Participant, CanBeCreatedByManyThreadsInOneDomain) {
    const BusOptions options = own_world("many", 108);
    std::atomic<int> num_failed = 0;
    {
        std::vector<std::jthread> threads;
        for (int i = 0; i < 4; ++i) {
            threads.emplace_back([&] {
                for (int round = 0; round < 10; ++round) {
                    const auto participant = Participant::create(options);
                    if (!participant || !Writer<SiteMesh>::create(*participant)) ++num_failed;
                }
            });
        }
    }
    EXPECT_EQ(num_failed, 0);
}

TEST(Participant, RefusesOtherNetworkSettingsUntilTheDomainIsClosed) {
    BusOptions options = own_world("settings", 105);
    BusOptions other = options;
    other.network = atrium::test::source_dir() + "/qos/wan.xml";
    {
        const auto first = value(Participant::create(options));
        const auto second = value(Participant::create(options));
        EXPECT_EQ(error_of(other).kind, ErrorKind::kConfiguration);
        EXPECT_THAT(error_of(other).message, HasSubstr("already open"));
    }
    EXPECT_TRUE(Participant::create(other).has_value());
}

TEST(Participant, CycloneAcceptsEachNetworkFileOfTheProject) {
    for (const char* name : {"loopback", "lan", "wifi", "wan"}) {
        BusOptions options = own_world("files", 106);
        options.network = std::string(atrium::test::source_dir() + "/qos/") + name + ".xml";
        const auto participant = Participant::create(options);
        EXPECT_TRUE(participant.has_value()) << name << ": " << participant.error().message;
    }
}

}  // namespace
}  // namespace atrium::bus
