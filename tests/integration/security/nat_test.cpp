#include "core/keys/private_file.hpp"
#include "core/keys/store.hpp"
#include "tests/support/network/impaired_network.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

// Two rooms in two cities: a hub that everybody reaches, and three homes behind routers that let
// nothing in (masquerade), with 50 ms and 1 % loss between them. Only commands that a user types.
namespace atrium::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

// The hub, and the routers of alice, bob and carol.
enum Host : int { kHub, kAlice, kBob, kCarol, kNumHosts };
constexpr const char* kNames[] = {"playroom", "alice", "bob", "carol"};

// A home network behind the router that this runs on: prints the id of a process in it.
constexpr const char* kHome = R"sh(
set -e
unshare -n sleep 100000 &
home=$!
until [ "$(readlink /proc/$home/ns/net)" != "$(readlink /proc/$$/ns/net)" ]; do sleep 0.02; done
ip link add inside type veth peer name eth0 netns $home
ip address add 192.168.1.1/24 dev inside
ip link set inside up
in_home="nsenter -t $home -n"
$in_home ip link set lo up
$in_home ip address add 192.168.1.2/24 dev eth0
$in_home ip link set eth0 up
$in_home ip route add default via 192.168.1.1
echo 1 > /proc/sys/net/ipv4/ip_forward
nft -f - <<END
table ip home {
    chain leaves {
        type nat hook postrouting priority 100;
        oifname "link0" masquerade
    }
    chain passes {
        type filter hook forward priority 0; policy drop;
        iifname "inside" accept
        ct state established,related accept
    }
    chain enters {
        type filter hook input priority 0; policy drop;
        iifname "inside" accept
        ct state established,related accept
    }
}
END
echo "home $home"
wait
)sh";

class Nat : public testing::Test {
protected:
    void SetUp() override {
        auto network = ImpairedNetwork::create(kNumHosts, 23);
        if (!network) GTEST_SKIP() << skip::kNoNetwork << network.error().message;
        for (const char* tool : {"/usr/sbin/nft", "/usr/bin/wg", "/usr/bin/wireguard-go"})
            if (!fs::exists(tool)) GTEST_SKIP() << skip::kNoNetwork << tool << " is missing";
        network_ = std::move(*network);
        for (int host = kAlice; host < kNumHosts; ++host) {
            // from home to home two lines: a round trip of 50 ms, and 1 % lost each way
            const Impairment line{.delay = 12'500us, .loss = 0.005};
            network_->set(host, Way::kUp, line);
            network_->set(host, Way::kDown, line);
            homes_[host] = value(network_->start(host, {"/bin/bash", "-c", kHome}));
            ASSERT_TRUE(homes_[host]->wait_for_output("home ", 20s)) << homes_[host]->output();
        }
    }

    template <typename T>
    static T value(Expected<T> expected) {
        if (!expected) throw std::runtime_error(expected.error().message);
        return std::move(*expected);
    }

    std::string file_of(int host) const {
        return (folder_ / (std::string(kNames[host]) + ".invitation")).string();
    }

    // A shell command inside of a home, or at the hub.
    std::unique_ptr<HostedProcess> start(int host, const std::string& command) {
        std::string where;
        if (host != kHub) {
            const std::string output = homes_[host]->output();
            where = fmt::format("nsenter -t {} -n ",
                                std::stoi(output.substr(output.find("home ") + 5)));
        }
        // WireGuard in user space keeps its socket in /run: each home its own
        const std::string run = (folder_ / fmt::format("run{}", host)).string();
        fs::create_directories(run);
        return value(network_->start(
            host,
            {"/bin/bash",
             "-c",
             fmt::format("exec {}unshare -m bash -c 'mount --bind {} /run; cd {}; exec {}'",
                         where,
                         run,
                         source_dir(),
                         command)}));
    }
    std::string program(const std::string& name) const {
        return std::string(ATRIUM_BIN_DIR) + "/" + name + " ";
    }
    void tunnel_up(int host) {
        // wireguard-go, which it starts, ends with the process group
        tunnels_.push_back(
            start(host, fmt::format("{}up {} --foreground", program("tunnel"), file_of(host))));
        ASSERT_TRUE(tunnels_.back()->wait_for_output("is up", 30s)) << tunnels_.back()->output();
    }

    TemporaryFolder folder_;
    std::unique_ptr<ImpairedNetwork> network_;
    std::unique_ptr<HostedProcess> homes_[kNumHosts];
    std::vector<std::unique_ptr<HostedProcess>> tunnels_;
    std::vector<std::unique_ptr<HostedProcess>> programs_;
};

// How long frames are counted; docs/measurements/security.md has five minutes.
std::chrono::seconds counted() {
    const char* seconds = std::getenv("ATRIUM_NAT_SECONDS");
    return std::chrono::seconds(seconds == nullptr ? 10 : std::stoi(seconds));
}

TEST_F(Nat, TwoRoomsMeetThroughAHub) {
    const auto begin = std::chrono::steady_clock::now();
    const std::string keys = (folder_ / "playroom.keys").string();
    const auto keys_command = [&](const std::string& arguments) {
        const auto done = value(HostedProcess::start(
            {"/bin/bash", "-c", fmt::format("{}{} --keys {}", program("keys"), arguments, keys)}));
        ASSERT_EQ(done->wait(30s), 0) << done->output();
    };
    keys_command("init playroom");
    keys_command(
        fmt::format("invite site alice --hub {} -o {}", network_->address(kHub), file_of(kAlice)));
    keys_command("invite site bob -o " + file_of(kBob));
    keys_command("invite viewer carol -o " + file_of(kCarol));
    keys_command("export playroom -o " + file_of(kHub));
    for (int host = kHub; host < kNumHosts; ++host) tunnel_up(host);

    programs_.push_back(start(
        kHub,
        program("world_server") + "--config deploy/worlds/demo.toml --join " + file_of(kHub)));
    for (const int site : {kAlice, kBob})
        programs_.push_back(start(site,
                                  fmt::format("{}--config deploy/sites/{}.toml --join {}",
                                              program("site_node"),
                                              kNames[site],
                                              file_of(site))));
    const std::string picture = (folder_ / "both.png").string();
    auto viewer = start(kCarol,
                        fmt::format("{}--join {} --headless --view.width 320 --view.height 240 "
                                    "--wait_people 2 --wait_timeout_s 120 --frames 5 --output {}",
                                    program("viewer"),
                                    file_of(kCarol),
                                    picture));
    ASSERT_EQ(viewer->wait(150s), 0) << viewer->output();
    EXPECT_TRUE(fs::exists(picture));
    const std::chrono::duration<double> until_picture = std::chrono::steady_clock::now() - begin;
    RecordProperty("seconds_until_picture", fmt::format("{:.1f}", until_picture.count()));
    std::printf("until both people are in one picture: %.1f s\n", until_picture.count());

    auto watch = start(
        kCarol, fmt::format("{}--join {} --ignore 3", program("stream_watch"), file_of(kCarol)));
    ASSERT_TRUE(watch->wait_for_output("first alice", 30s)) << watch->output();
    ASSERT_TRUE(watch->wait_for_output("first bob", 30s)) << watch->output();
    std::this_thread::sleep_for(3s + counted());  // the time that is measured
    watch->signal(SIGTERM);
    ASSERT_TRUE(watch->wait(20s));
    std::printf("%s", watch->output().c_str());
    for (const char* site : {"alice", "bob"})
        EXPECT_THAT(watch->output(),
                    testing::ContainsRegex(
                        fmt::format("site {} received [0-9]+ missing [0-9]+ lost 0 ", site)))
            << programs_[1]->output() << programs_[2]->output();

    // alice's home gets another address, as a laptop that changes its network
    watch = start(kCarol, fmt::format("{}--join {}", program("stream_watch"), file_of(kCarol)));
    ASSERT_TRUE(watch->wait_for_output("first alice", 30s)) << watch->output();
    const auto moved =
        start(kAlice,
              "bash -c \"ip address flush dev eth0; ip address add 192.168.1.77/24 dev "
              "eth0; ip route add default via 192.168.1.1\"");
    ASSERT_EQ(moved->wait(10s), 0) << moved->output();
    std::this_thread::sleep_for(8s);  // longer than it may take
    watch->signal(SIGTERM);
    ASSERT_TRUE(watch->wait(20s));
    std::printf("%s", watch->output().c_str());
    const std::string output = watch->output();
    const auto at = output.find("longest_gap_ms ", output.find("site alice"));
    ASSERT_NE(at, std::string::npos) << output;
    EXPECT_LT(std::stod(output.substr(at + 15)), 5000.0) << output;
    for (auto& running : programs_) {
        running->signal(SIGTERM);
        EXPECT_EQ(running->wait(30s), 0) << running->output();
    }
}

}  // namespace
}  // namespace atrium::test
