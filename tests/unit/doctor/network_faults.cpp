#include "tests/unit/doctor/faults.hpp"

#include <utility>

namespace atrium::doctor {
namespace {

const std::string kEth0 = "/sys/class/net/eth0/";
const std::string kEth1 = "/sys/class/net/eth1/";

// The rules that `nft -j list ruleset` printed for one input chain, with these rules in it.
std::string nft_with(const std::string& table,
                     const std::string& policy,
                     const std::vector<std::string>& expressions,
                     const std::string& family = "inet",
                     const std::string& chain = "input") {
    const std::string place = R"({"family": ")" + family + R"(", "table": ")" + table;
    std::string json = R"({"nftables": [{"metainfo": {"version": "1.0.6"}}, {"chain": )" + place +
                       R"(", "name": ")" + chain +
                       R"(", "handle": 1, "type": "filter", "hook": "input", "prio": 0, )"
                       R"("policy": ")" +
                       policy + "\"}}";
    for (const std::string& expression : expressions) {
        json += R"(, {"rule": )" + place + R"(", "chain": ")" + chain +
                R"(", "handle": 5, "expr": [)" + expression + "]}}";
    }
    return json + "]}\n";
}

const std::string kDropDds =
    R"({"match": {"op": "==", "left": {"payload": {"protocol": "udp", "field": "dport"}}, )"
    R"("right": {"range": [7400, 7500]}}}, {"counter": {"packets": 0, "bytes": 0}}, {"drop": null})";
const std::string kDropCameras =
    R"({"match": {"op": "==", "left": {"payload": {"protocol": "udp", "field": "sport"}}, )"
    R"("right": 3956}}, {"drop": null})";
const std::string kAcceptEth1 =
    R"({"match": {"op": "==", "left": {"meta": {"key": "iifname"}}, "right": "eth1"}}, )"
    R"({"accept": null})";
const std::string kAcceptEstablished =
    R"({"match": {"op": "in", "left": {"ct": {"key": "state"}}, "right": ["established", )"
    R"("related"]}}, {"accept": null})";

void set_nft(FakeHost& host, const std::string& json) {
    host.outputs["nft -j list ruleset"] = {0, json};
}

void only_world(Options& options) { options.roles = Roles{.world = true}; }

// Routes without a default route, one of them to multicast addresses.
constexpr const char* kRoutesOfMulticast =
    "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT\n"
    "eth0\t0000000A\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n"
    "eth0\t000000E0\t00000000\t0001\t0\t0\t0\t000000F0\t0\t0\t0\n";
constexpr const char* kRoutesOfEth0 =
    "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT\n"
    "eth0\t0000000A\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n";

std::vector<Fault> setting_faults() {
    const auto setting = [](std::string name,
                            std::string id,
                            std::string file,
                            std::string value,
                            std::string text,
                            std::string cure,
                            std::string keep) {
        return Fault{std::move(name),
                     std::move(id),
                     [file, value](FakeHost& host, Options&) { host.write(file, value); },
                     std::move(text),
                     std::move(cure),
                     std::move(keep)};
    };
    return {setting("ReceiveBuffer",
                    "receive_buffer_small",
                    "/proc/sys/net/core/rmem_max",
                    "212992",
                    "net.core.rmem_max is 208 KiB; Atrium asks for 16 MiB",
                    "sudo sysctl -w net.core.rmem_max=16777216",
                    "echo 'net.core.rmem_max = 16777216' | sudo tee "
                    "/etc/sysctl.d/99-zz-atrium-rmem_max.conf"),
            setting("SendBuffer",
                    "send_buffer_small",
                    "/proc/sys/net/core/wmem_max",
                    "212992",
                    "wmem_max is 208 KiB; Atrium asks for 2 MiB",
                    "sudo sysctl -w net.core.wmem_max=2097152",
                    "wmem_max.conf"),
            setting("FragmentTime",
                    "fragments_kept_long",
                    "/proc/sys/net/ipv4/ipfrag_time",
                    "30",
                    "is 30 s; a LAN wants 3 s",
                    "sudo sysctl -w net.ipv4.ipfrag_time=3",
                    "ipfrag_time.conf"),
            setting("FragmentMemory",
                    "fragment_memory_small",
                    "/proc/sys/net/ipv4/ipfrag_high_thresh",
                    "4194304",
                    "4 MiB; Atrium asks for 128 MiB",
                    "sudo sysctl -w net.ipv4.ipfrag_high_thresh=134217728",
                    "ipfrag_high_thresh.conf"),
            setting("SlowLink",
                    "link_slow",
                    kEth0 + "speed",
                    "100",
                    "eth0 (other hosts) has 100 Mbit/s; wanted are 1000",
                    "sudo ethtool -s eth0 speed 1000 duplex full autoneg on",
                    ""),
            setting("SlowLinkOfCameras",
                    "link_slow",
                    kEth1 + "speed",
                    "100",
                    "eth1 (cameras) has 100 Mbit/s",
                    "sudo ethtool -s eth1",
                    ""),
            setting("HalfDuplex",
                    "link_half_duplex",
                    kEth0 + "duplex",
                    "half",
                    "eth0 (other hosts) is half duplex, 1000 Mbit/s",
                    "sudo ethtool -s eth0 speed 1000 duplex full autoneg on",
                    ""),
            setting("LostPackets",
                    "card_loses_packets",
                    kEth1 + "statistics/rx_missed_errors",
                    "50000",
                    "eth1 (cameras) lost 50000 packets (0.05 %)",
                    "sudo ethtool -G eth1 rx 2048",
                    "ATTR{address}==\"00:11:22:33:44:01\""),
            setting("BadCable",
                    "cable_bad",
                    kEth1 + "statistics/rx_crc_errors",
                    "20000",
                    "eth1 (cameras) got 20000 packets",
                    "ip -s -s link show dev eth1",
                    ""),
            setting("NoMulticastFlag",
                    "card_without_multicast",
                    kEth0 + "flags",
                    "0x3",
                    "eth0 (10.0.0.2) does not take part in multicast",
                    "sudo ip link set dev eth0 multicast on",
                    "RUN+=\"/usr/sbin/ip link set dev $name multicast on\"")};
}

std::vector<Fault> card_faults() {
    return {{"CardsDown",
             "no_network_card",
             [](FakeHost& host, Options& options) {
                 host.write(kEth0 + "flags", "0x1002");
                 host.remove(kEth1);
                 host.addresses.resize(1);
                 only_world(options);
             },
             "No network card is up (eth0 is down)",
             "sudo ip link set dev eth0 up && sudo dhclient eth0"},
            {"CardWithoutAddress",
             "no_network_card",
             [](FakeHost& host, Options& options) {
                 host.remove(kEth1);
                 host.addresses.resize(1);
                 only_world(options);
             },
             "eth0 is up, but has no IPv4 address",
             "sudo dhclient eth0"},
            {"OnlyLoopback",
             "no_network_card",
             [](FakeHost& host, Options& options) {
                 host.remove(kEth0);
                 host.remove(kEth1);
                 host.addresses.resize(1);
                 only_world(options);
             },
             "no network card but loopback",
             "/bin/world_server --network loopback"},
            {"InterfaceMissing",
             "card_missing",
             [](FakeHost&, Options& options) { options.interface = "eth7"; },
             "'eth7' of bus.interface is missing or down",
             "sudo ip link set dev eth7 up"},
            {"NoDefaultRoute",
             "card_chosen_by_chance",
             [](FakeHost& host, Options&) { host.write("/proc/net/route", kRoutesOfMulticast); },
             "Atrium takes eth0, not eth1",
             "/bin/site_node --network lan --interface eth0"},
            {"NoMulticastRoute",
             "no_multicast_route",
             [](FakeHost& host, Options& options) {
                 host.write("/proc/net/route", kRoutesOfEth0);
                 options.interface = "eth0";
             },
             "No route leads to multicast",
             "sudo ip route add 224.0.0.0/4 dev eth0"},
            {"MulticastNotHeard",
             "multicast_not_heard",
             [](FakeHost& host, Options&) { host.is_multicast_heard = false; },
             "239.255.0.1 port 7400 by eth0 (10.0.0.2)",
             "--peers HOST1,HOST2"},
            {"MulticastNotHeardAndRulesUnknown",
             "multicast_not_heard",
             [](FakeHost& host, Options&) {
                 host.is_multicast_heard = false;
                 host.outputs["nft -j list ruleset"] = {1, "Operation not permitted\n"};
             },
             "is not heard on this host",
             "sudo apt install nftables && sudo /"},
            {"SlowLinkWithoutEthtool",
             "link_slow",
             [](FakeHost& host, Options&) {
                 host.write(kEth0 + "speed", "100");
                 host.write("/usr/sbin/ip", "");
             },
             "100 Mbit/s",
             "sudo apt install ethtool && sudo ethtool -s eth0"},
            {"LostPacketsWithTheLargestRing",
             "card_loses_packets",
             [](FakeHost& host, Options&) {
                 host.write(kEth1 + "statistics/rx_missed_errors", "50000");
                 host.outputs["ethtool -g eth1"] = {0, ring_of(2048, 2048)};
             },
             "although it is the largest of the card",
             "sudo ethtool -g eth1"},
            {"LostPacketsWithoutEthtool",
             "card_loses_packets",
             [](FakeHost& host, Options&) {
                 host.write(kEth1 + "statistics/rx_missed_errors", "50000");
                 host.outputs.erase("ethtool -g eth1");
                 host.write("/usr/sbin/ip", "");
             },
             "its receive ring was full; wanted",
             "sudo apt install ethtool && sudo ethtool -g eth1"},
            {"TwoCardsInOneSubnet",
             "cards_in_one_subnet",
             [](FakeHost& host, Options&) {
                 host.addresses.push_back({"eth1", 0x0A000003, 24});
             },
             "eth0 (10.0.0.2/24) and eth1 (10.0.0.3/24)",
             "sudo ip address del 10.0.0.3/24 dev eth1"}};
}

std::vector<Fault> firewall_faults() {
    return {
        {"NftDropsDds",
         "firewall_drops_dds",
         [](FakeHost& host, Options&) {
             set_nft(host, nft_with("filter", "accept", {kAcceptEstablished, kDropDds}));
         },
         "nftables, chain inet filter input) drops UDP to port 7400",
         "sudo nft insert rule inet filter input udp dport 7400-7649 accept",
         "(cat /etc/nftables.conf; echo 'insert rule inet filter input udp dport 7400-7649 "
         "accept') | sudo nft -c -f - && echo 'insert rule inet filter input udp dport "
         "7400-7649 accept' | sudo tee -a /etc/nftables.conf && sudo systemctl enable nftables"},
        {"NftDropsDdsInTheTableOfIptables",
         "firewall_drops_dds",
         [](FakeHost& host, Options&) {
             set_nft(host, nft_with("filter", "accept", {kDropDds}, "ip", "INPUT"));
         },
         "nftables, chain ip filter INPUT) drops UDP to port 7400",
         "sudo iptables -I INPUT -p udp --dport 7400:7649 -j ACCEPT",
         "netfilter-persistent save"},
        {"NftPolicyDrops",
         "firewall_drops_dds",
         [](FakeHost& host, Options&) {
             set_nft(host, nft_with("filter", "drop", {kAcceptEstablished, kAcceptEth1}));
         },
         "drops UDP to port 7400",
         "udp dport 7400-7649 accept",
         "/etc/nftables.conf"},
        {"NftDropsCameras",
         "firewall_drops_cameras",
         [](FakeHost& host, Options&) {
             set_nft(host, nft_with("filter", "accept", {kDropCameras}));
         },
         "drops UDP from port 3956",
         "sudo nft insert rule inet filter input iifname eth1 meta l4proto udp accept",
         "/etc/nftables.conf"},
        {"UfwDropsDds",
         "firewall_drops_dds",
         [](FakeHost& host, Options&) {
             host.write("/etc/ufw/ufw.conf", "# ufw\nENABLED=yes\n");
             set_nft(host, nft_with("filter", "accept", {kDropDds}));
         },
         "drops UDP to port 7400",
         "sudo ufw allow 7400:7649/udp"},
        {"FirewalldDropsDds",
         "firewall_drops_dds",
         [](FakeHost& host, Options&) {
             set_nft(host, nft_with("firewalld", "accept", {kDropDds}));
         },
         "drops UDP to port 7400",
         "sudo firewall-cmd --permanent --add-port=7400-7649/udp"},
        {"FirewalldDropsCameras",
         "firewall_drops_cameras",
         [](FakeHost& host, Options&) {
             set_nft(host, nft_with("firewalld", "accept", {kDropCameras}));
         },
         "cameras do not arrive.",
         "sudo firewall-cmd --permanent --add-rich-rule='rule family=\"ipv4\" source "
         "address=\"192.168.1.0/24\" protocol value=\"udp\" accept' && sudo firewall-cmd "
         "--reload"},
        {"FirewalldDropsCamerasAtNoCard",
         "firewall_drops_cameras",
         [](FakeHost& host, Options& options) {
             options.network = "loopback";
             for (const std::string& card : {kEth0, kEth1}) host.remove(card);
             host.addresses.resize(1);
             set_nft(host, nft_with("firewalld", "accept", {kDropCameras}));
         },
         "do not arrive. The command lets UDP of other hosts in, too.",
         "--add-rich-rule='rule protocol value=\"udp\" accept'"},
        {"NftDropsCamerasAtTheOnlyCard",
         "firewall_drops_cameras",
         [](FakeHost& host, Options&) {
             host.set_cameras({{"10.0.0.11", "101"}});
             host.write(kEth0 + "mtu", "9000");
             set_nft(host, nft_with("filter", "accept", {kDropCameras}));
         },
         "do not arrive. The command lets UDP of other hosts in, too.",
         "sudo nft insert rule inet filter input iifname eth0 meta l4proto udp accept",
         "/etc/nftables.conf"},
        {"IptablesDropsDds",
         "firewall_drops_dds",
         [](FakeHost& host, Options&) {
             host.outputs["nft -j list ruleset"] = {1, "Operation not permitted\n"};
             host.outputs["iptables-save"] = {
                 0,
                 "*filter\n:INPUT DROP [0:0]\n:FORWARD ACCEPT [0:0]\n"
                 "-A INPUT -i eth1 -j ACCEPT\n"
                 "-A INPUT -p udp -m udp --dport 7400 -j ACCEPT\nCOMMIT\n"};
         },
         "iptables, chain INPUT) drops UDP to port 7410",
         "sudo iptables -I INPUT -p udp --dport 7400:7649 -j ACCEPT",
         "netfilter-persistent save"}};
}

}  // namespace

std::vector<Fault> network_faults() {
    std::vector<Fault> faults = setting_faults();
    for (std::vector<Fault> more : {card_faults(), firewall_faults()})
        std::move(more.begin(), more.end(), std::back_inserter(faults));
    return faults;
}

}  // namespace atrium::doctor
