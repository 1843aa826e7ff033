#include "tools/tunnel/tunnel.hpp"

#include "tests/unit/tunnel/recorded_commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::tunnel_tool {
namespace {

std::string table() { return std::to_string(hub_table("wg-playroom")); }

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kCard;
using testing::kPrivateKey;
using ::testing::Not;
using testing::RecordedCommands;
using ::testing::StartsWith;
using testing::tunnel_of;

class TunnelCommands : public ::testing::Test {
protected:
    TunnelCommands() { host_.answer("ip link show", 1, "Device does not exist.\n"); }

    std::string failure_of_up(const std::string& name = "bob") {
        const auto up = bring_up(tunnel_of(name), kCard, host_.run());
        if (up) return "no failure";
        EXPECT_EQ(up.error().kind, ErrorKind::kUnavailable);
        EXPECT_THAT(up.error().message, Not(HasSubstr(kPrivateKey.substr(0, 20))));
        return up.error().message;
    }
    void expect_up(const std::string& name) {
        const auto up = bring_up(tunnel_of(name), kCard, host_.run());
        EXPECT_TRUE(up) << up.error().message;
    }
    void has_no_wireguard_in_the_kernel() {
        host_.answer("ip link add", 2, "Error: Unknown device type.\n");
    }

    RecordedCommands host_;
};

TEST_F(TunnelCommands, MakeACardInTheKernel) {
    expect_up("bob");
    EXPECT_THAT(host_.lines,
                ElementsAre("ip link show dev wg-playroom",
                            "ip link add dev wg-playroom type wireguard",
                            "wg syncconf wg-playroom /dev/stdin",
                            "ip address replace 10.200.7.2/24 dev wg-playroom",
                            "ip link set dev wg-playroom mtu 1420 up"));
}

TEST_F(TunnelCommands, MakeACardWithoutTheKernel) {
    has_no_wireguard_in_the_kernel();
    expect_up("bob");
    EXPECT_THAT(host_.lines,
                ElementsAre("ip link show dev wg-playroom",
                            "ip link add dev wg-playroom type wireguard",
                            "wireguard-go wg-playroom",
                            "wg syncconf wg-playroom /dev/stdin",
                            "ip address replace 10.200.7.2/24 dev wg-playroom",
                            "ip link set dev wg-playroom mtu 1420 up"));
}

TEST_F(TunnelCommands, ReconfigureACardThatIsThere) {
    host_.answer("ip link show", 0, "7: wg-playroom: <POINTOPOINT,NOARP,UP,LOWER_UP> mtu 1420");
    host_.answer("ip -4 -o address show", 0, "7: wg-playroom    inet 10.200.7.2/24 scope global\n");
    expect_up("bob");
    EXPECT_THAT(host_.lines,
                ElementsAre("ip link show dev wg-playroom",
                            "ip -4 -o address show dev wg-playroom",
                            "wg syncconf wg-playroom /dev/stdin",
                            "ip address replace 10.200.7.2/24 dev wg-playroom",
                            "ip link set dev wg-playroom mtu 1420 up"));
}

TEST_F(TunnelCommands, LeaveTheCardToAnotherPlace) {
    host_.answer("ip link show", 0, "7: wg-playroom: <POINTOPOINT,NOARP,UP,LOWER_UP> mtu 1420");
    // bob's address begins like that of this place
    host_.answer(
        "ip -4 -o address show", 0, "7: wg-playroom    inet 10.200.7.22/24 scope global\n");
    const auto up = bring_up(tunnel_of("bob"), kCard, host_.run());
    ASSERT_FALSE(up);
    EXPECT_EQ(up.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(up.error().message,
                AllOf(HasSubstr("is up for another place than bob"), HasSubstr("--join FILE")));
    EXPECT_EQ(host_.lines.size(), 2u) << "nothing is changed";
}

TEST_F(TunnelCommands, LetTheHubPassPacketsOnBetweenSpokesOnly) {
    expect_up("hall");
    EXPECT_THAT(std::vector(host_.lines.begin() + 2, host_.lines.end()),
                ElementsAre("wg syncconf wg-playroom /dev/stdin",
                            "ip address replace 10.200.7.1/24 dev wg-playroom",
                            "ip link set dev wg-playroom mtu 1420 up",
                            "sysctl -q -w net/ipv4/conf/wg-playroom/forwarding=1",
                            "ip route replace 10.200.7.0/24 dev wg-playroom table " + table(),
                            "ip route replace unreachable default table " + table(),
                            "ip rule show iif wg-playroom",
                            "ip rule add iif wg-playroom lookup " + table()));
}

TEST_F(TunnelCommands, AddTheRuleOfTheHubOnce) {
    host_.answer("ip rule show", 0, "32765:\tfrom all iif wg-playroom lookup 51820\n");
    expect_up("hall");
    EXPECT_THAT(
        host_.lines,
        AllOf(Contains("ip rule show iif wg-playroom"), Each(Not(StartsWith("ip rule add")))));
}

TEST_F(TunnelCommands, ChangeNoRoutesOfASpoke) {
    expect_up("alice");
    EXPECT_THAT(
        host_.lines,
        Each(AllOf(
            Not(StartsWith("sysctl")), Not(StartsWith("ip route")), Not(StartsWith("ip rule")))));
}

TEST_F(TunnelCommands, GiveThePrivateKeyToTheInputOfWgOnly) {
    for (const char* name : {"hall", "bob"}) {
        host_.lines.clear();
        host_.inputs.clear();
        expect_up(name);
        ASSERT_TRUE(take_down(tunnel_of(name), kCard, host_.run()));
        for (std::size_t i = 0; i < host_.lines.size(); ++i) {
            EXPECT_THAT(host_.lines[i], Not(HasSubstr(kPrivateKey)));
            const bool is_wg = host_.lines[i].starts_with("wg syncconf ");
            EXPECT_EQ(host_.inputs[i], is_wg ? keys::wireguard_text(tunnel_of(name)) : "")
                << host_.lines[i];
        }
    }
}

TEST_F(TunnelCommands, AreReadByNoShell) {
    has_no_wireguard_in_the_kernel();
    const std::string card = "wg-$(reboot);a b";
    ASSERT_TRUE(bring_up(tunnel_of("hall"), card, host_.run()));
    ASSERT_TRUE(take_down(tunnel_of("hall"), card, host_.run()));
    for (const auto& command : host_.commands) {
        EXPECT_THAT(command.front(), ::testing::AnyOf("ip", "wg", "wireguard-go", "sysctl"));
        const std::string line = fmt::format("{}", fmt::join(command, " "));
        if (line.find("wg-") == std::string::npos) continue;
        // the card is a word of its own, or the middle of a name of sysctl
        EXPECT_THAT(command, Contains(::testing::AnyOf(card, HasSubstr("/" + card + "/")))) << line;
    }
}

TEST_F(TunnelCommands, NameWhatToInstallWithoutAnyWireGuard) {
    has_no_wireguard_in_the_kernel();
    host_.answer("wireguard-go", kNoSuchProgram);
    EXPECT_THAT(
        failure_of_up(),
        AllOf(HasSubstr("`apt install wireguard-tools`"), HasSubstr("`apt install wireguard-go`")));
    EXPECT_THAT(host_.lines, Each(Not(StartsWith("wg "))));
}

TEST_F(TunnelCommands, SayWhyWireGuardGoFailed) {
    has_no_wireguard_in_the_kernel();
    host_.answer("wireguard-go", 1, "a banner\nof lines\nFailed to create TUN device: no tun\n\n");
    EXPECT_THAT(failure_of_up(),
                AllOf(HasSubstr("(wireguard-go: Failed to create TUN device: no tun)"),
                      Not(HasSubstr("banner"))));
    EXPECT_THAT(host_.lines, Each(Not(StartsWith("wg "))));
    host_.answer("wireguard-go", 1, "\n\n");
    EXPECT_THAT(failure_of_up(), HasSubstr("(wireguard-go: )"));
}

TEST_F(TunnelCommands, NameAMissingProgram) {
    host_.answer("wg ", kNoSuchProgram);
    EXPECT_THAT(failure_of_up(),
                AllOf(HasSubstr("there is no program wg"), HasSubstr("`apt install ")));
}

TEST_F(TunnelCommands, NeedRoot) {
    host_.answer("ip link add", 2, "RTNETLINK answers: Operation not permitted\n");
    EXPECT_THAT(failure_of_up(), AllOf(HasSubstr("only root"), HasSubstr("sudo")));
    EXPECT_THAT(host_.lines, Each(Not(StartsWith("wireguard-go"))));
    // the card is there, and belongs to root
    host_.answer("ip link show", 0);
    for (const char* said : {"Unable to modify interface: Operation not permitted\n",
                             "fopen: Permission denied\n",
                             "sysctl: permission denied on key\n"}) {
        host_.answer("wg syncconf", 1, said);
        EXPECT_THAT(failure_of_up(), HasSubstr("put sudo before this command")) << said;
    }
    host_.answer("wg syncconf", 1, "Unable to modify interface: No such device\n");
    EXPECT_THAT(failure_of_up(),
                AllOf(HasSubstr("`wg syncconf wg-playroom /dev/stdin` failed: Unable to modify "
                                "interface: No such device"),
                      Not(HasSubstr("sudo"))));
}

TEST_F(TunnelCommands, KeepThePrivateKeyOutOfErrors) {
    for (const std::string& said : {"Key is not the correct length or format: `" + kPrivateKey +
                                        "'\nConfiguration parsing error\n",
                                    "Line unrecognized: `PrivateKey=" + kPrivateKey + "'",
                                    std::string(270, ' ') + kPrivateKey,
                                    kPrivateKey + kPrivateKey}) {
        host_.answer("wg syncconf", 1, said);
        const std::string failure = failure_of_up();  // looks for the key
        EXPECT_THAT(failure, HasSubstr("`wg syncconf wg-playroom /dev/stdin` failed: "));
    }
    host_.answer("wg syncconf", 1, "Line unrecognized: `PrivateKey=" + kPrivateKey + "'");
    EXPECT_THAT(failure_of_up(), HasSubstr("Line unrecognized: `PrivateKey=...'"));
}

TEST_F(TunnelCommands, ShowNoControlCharactersInErrors) {
    host_.answer("wg syncconf", 1, "\x1B[2Jbad\nnews " + std::string(1000, 'x'));
    const std::string failure = failure_of_up();
    EXPECT_THAT(failure, HasSubstr("bad news x"));
    EXPECT_EQ(failure.find_first_of("\x1B\n"), std::string::npos);
    EXPECT_LT(failure.size(), 400u);
}

TEST_F(TunnelCommands, StopAtTheFirstFailure) {
    for (const char* failing : {"wg syncconf",
                                "ip address",
                                "ip link set",
                                "sysctl",
                                "ip route",
                                "ip route replace unreachable",
                                "ip rule show",
                                "ip rule add"}) {
        RecordedCommands host;
        host.answer(failing, 1, "no");
        const auto up = bring_up(tunnel_of("hall"), kCard, host.run());
        ASSERT_FALSE(up) << failing;
        EXPECT_THAT(up.error().message, HasSubstr(failing));
        EXPECT_THAT(host.lines.back(), StartsWith(failing));
    }
}

TEST_F(TunnelCommands, RemoveTheCardOfASpoke) {
    host_.answer("ip link show", 0);
    ASSERT_TRUE(take_down(tunnel_of("bob"), kCard, host_.run()));
    EXPECT_THAT(host_.lines,
                ElementsAre("ip link show dev wg-playroom", "ip link delete dev wg-playroom"));
}

TEST_F(TunnelCommands, RemoveTheRoutesOfTheHub) {
    host_.answer("ip link show", 0);
    ASSERT_TRUE(take_down(tunnel_of("hall"), kCard, host_.run()));
    EXPECT_THAT(host_.lines,
                ElementsAre("ip rule del iif wg-playroom lookup " + table(),
                            "ip route flush table " + table(),
                            "ip link show dev wg-playroom",
                            "ip link delete dev wg-playroom"));
}

TEST_F(TunnelCommands, RemoveNothingWithoutACard) {
    host_.answer("ip rule del", 2, "RTNETLINK answers: No such file or directory\n");
    host_.answer("ip route flush", 2);
    EXPECT_TRUE(take_down(tunnel_of("hall"), kCard, host_.run()));
    EXPECT_THAT(host_.lines, Each(Not(StartsWith("ip link delete"))));
}

TEST_F(TunnelCommands, NeedRootToRemoveTheCard) {
    host_.answer("ip link show", 0);
    host_.answer("ip link delete", 2, "RTNETLINK answers: Operation not permitted\n");
    const auto down = take_down(tunnel_of("bob"), kCard, host_.run());
    ASSERT_FALSE(down);
    EXPECT_EQ(down.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(down.error().message, HasSubstr("put sudo before this command"));
}

TEST_F(TunnelCommands, FailWithoutResourcesOfThisProcess) {
    const tunnel_tool::Run none = [](const std::vector<std::string>&, std::string_view) {
        return std::optional<CommandOutput>();
    };
    EXPECT_FALSE(bring_up(tunnel_of("bob"), kCard, none));
    const auto output = run_or_fail(none, {"wg", "show"});
    ASSERT_FALSE(output);
    EXPECT_THAT(output.error().message, HasSubstr("`wg show` failed: no answer"));
}

}  // namespace
}  // namespace atrium::tunnel_tool
