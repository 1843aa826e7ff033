#include "tools/doctor/checks/firewall_rules.hpp"

#include <gtest/gtest.h>

#include <string>

namespace atrium::doctor {
namespace {

const Datagram kDds{.to = 0xEFFF0001, .from_port = 40'000, .to_port = 7400, .card = "eth0"};

// The table filter of iptables with these rules after its policy.
bool is_dropped(const std::string& rules, const Datagram& datagram = kDds) {
    return dropped_by(parse_iptables("*nat\n:PREROUTING DROP\n-A INPUT -j DROP\n*filter\n" + rules),
                      datagram) != nullptr;
}

TEST(Firewall, TakesTheFirstRuleThatHolds) {
    const std::string accept = ":INPUT ACCEPT [0:0]\n";
    EXPECT_FALSE(is_dropped(accept));
    EXPECT_TRUE(is_dropped(accept + "-A INPUT -p udp --dport 7400:7500 -j DROP\n"));
    EXPECT_TRUE(is_dropped(accept + "-A INPUT -p udp -j REJECT --reject-with icmp-x\n"));
    EXPECT_FALSE(is_dropped(accept + "-A INPUT -p tcp -j DROP\n"));
    EXPECT_FALSE(is_dropped(accept + "-A INPUT -p udp -m multiport --dports 53,7400 -j ACCEPT\n"
                                     "-A INPUT -j DROP\n"));
    EXPECT_TRUE(is_dropped(accept + "-A INPUT -i eth+ -j DROP\n"));
    EXPECT_FALSE(is_dropped(accept + "-A INPUT ! -i eth+ -j DROP\n"));
    EXPECT_FALSE(is_dropped(accept + "-A INPUT -d 10.0.0.0/8 -j DROP\n"));
    EXPECT_TRUE(is_dropped(accept + "-A INPUT -d 239.0.0.0/8 -j DROP\n"));
}

TEST(Firewall, DropsByPolicyWhatNoRuleAccepts) {
    const std::string drop = ":INPUT DROP [0:0]\n";
    EXPECT_TRUE(is_dropped(drop));
    EXPECT_TRUE(is_dropped(drop +
                           "-A INPUT -m state --state RELATED,ESTABLISHED -j ACCEPT\n"
                           "-A INPUT -i lo -j ACCEPT\n-A INPUT -p tcp --dport 22 -j ACCEPT\n"));
    EXPECT_FALSE(is_dropped(drop + "-A INPUT -i eth0 -j ACCEPT\n"));
}

TEST(Firewall, FollowsJumps) {
    const std::string chains = ":INPUT DROP [0:0]\n:lab - [0:0]\n";
    EXPECT_FALSE(is_dropped(chains + "-A INPUT -j lab\n-A lab -p udp -j ACCEPT\n"));
    EXPECT_TRUE(is_dropped(chains + "-A INPUT -j lab\n-A lab -j RETURN\n-A lab -j ACCEPT\n"));
    EXPECT_TRUE(is_dropped(chains + "-A INPUT -j lab\n-A lab -p tcp -j ACCEPT\n"));
}

// As iptables-save prints the rules of ufw 0.36.2 of Debian 12, without those for forwarding.
constexpr const char* kUfw = R"(:INPUT DROP [0:0]
:ufw-after-input - [0:0]
:ufw-after-logging-input - [0:0]
:ufw-before-input - [0:0]
:ufw-before-logging-input - [0:0]
:ufw-logging-allow - [0:0]
:ufw-logging-deny - [0:0]
:ufw-not-local - [0:0]
:ufw-reject-input - [0:0]
:ufw-skip-to-policy-input - [0:0]
:ufw-track-input - [0:0]
:ufw-user-input - [0:0]
-A INPUT -j ufw-before-logging-input
-A INPUT -j ufw-before-input
-A INPUT -j ufw-after-input
-A INPUT -j ufw-after-logging-input
-A INPUT -j ufw-reject-input
-A INPUT -j ufw-track-input
-A ufw-after-input -p udp -m udp --dport 137 -j ufw-skip-to-policy-input
-A ufw-after-input -p tcp -m tcp --dport 445 -j ufw-skip-to-policy-input
-A ufw-after-input -m addrtype --dst-type BROADCAST -j ufw-skip-to-policy-input
-A ufw-after-logging-input -m limit --limit 3/min --limit-burst 10 -j LOG --log-prefix "[UFW BLOCK] "
-A ufw-before-input -i lo -j ACCEPT
-A ufw-before-input -m conntrack --ctstate RELATED,ESTABLISHED -j ACCEPT
-A ufw-before-input -m conntrack --ctstate INVALID -j ufw-logging-deny
-A ufw-before-input -m conntrack --ctstate INVALID -j DROP
-A ufw-before-input -p icmp -m icmp --icmp-type 8 -j ACCEPT
-A ufw-before-input -p udp -m udp --sport 67 --dport 68 -j ACCEPT
-A ufw-before-input -j ufw-not-local
-A ufw-before-input -d 224.0.0.251/32 -p udp -m udp --dport 5353 -j ACCEPT
-A ufw-before-input -d 239.255.255.250/32 -p udp -m udp --dport 1900 -j ACCEPT
-A ufw-before-input -j ufw-user-input
-A ufw-logging-deny -m conntrack --ctstate INVALID -m limit --limit 3/min --limit-burst 10 -j RETURN
-A ufw-logging-deny -m limit --limit 3/min --limit-burst 10 -j LOG --log-prefix "[UFW BLOCK] "
-A ufw-not-local -m addrtype --dst-type LOCAL -j RETURN
-A ufw-not-local -m addrtype --dst-type MULTICAST -j RETURN
-A ufw-not-local -m addrtype --dst-type BROADCAST -j RETURN
-A ufw-not-local -m limit --limit 3/min --limit-burst 10 -j ufw-logging-deny
-A ufw-not-local -j DROP
-A ufw-skip-to-policy-input -j DROP
-A ufw-user-input -p tcp -m tcp --dport 22 -j ACCEPT
)";

TEST(Firewall, ReadsTheRulesOfUfw) {
    const Datagram data{.to = 0, .from_port = 40'000, .to_port = 7410, .card = "eth0"};
    for (const Datagram& datagram : {kDds, data}) {
        EXPECT_TRUE(is_dropped(kUfw, datagram));
        EXPECT_FALSE(is_dropped(std::string(kUfw) +
                                    "-A ufw-user-input -p udp -m multiport --dports 7400:7649 -j "
                                    "ACCEPT\n",
                                datagram));
    }
    EXPECT_FALSE(is_dropped(kUfw, {.to = 0xE00000FB, .to_port = 5353, .card = "eth0"}));
}

TEST(Firewall, ReturnsInDoubt) {
    const std::string odd = "-A lab -m recent --rcheck -j RETURN\n";
    const std::string chains = ":INPUT ACCEPT [0:0]\n:lab - [0:0]\n-A INPUT -j lab\n" + odd;
    EXPECT_FALSE(is_dropped(chains + "-A lab -j DROP\n"));
    EXPECT_TRUE(is_dropped(chains + "-A lab -j DROP\n-A INPUT -j DROP\n"));
    EXPECT_FALSE(is_dropped(chains + "-A lab -j ACCEPT\n-A INPUT -j DROP\n"));
    EXPECT_FALSE(is_dropped(chains + "-A INPUT -p udp -j ACCEPT\n-A INPUT -j DROP\n"));
}

TEST(Firewall, EndsJumpsInCircles) {
    std::string rules = ":INPUT ACCEPT [0:0]\n:a - [0:0]\n";
    for (int i = 0; i < 50; ++i) rules += "-A INPUT -j a\n-A a -j INPUT\n-A a -j a\n";
    EXPECT_FALSE(is_dropped(rules));
}

TEST(Firewall, AccusesNoRuleThatItDoesNotUnderstand) {
    EXPECT_FALSE(is_dropped(":INPUT ACCEPT [0:0]\n-A INPUT -m limit --limit 5/sec -j DROP\n"));
    EXPECT_FALSE(is_dropped(":INPUT DROP [0:0]\n-A INPUT -m set --match-set lan src -j ACCEPT\n"));
    EXPECT_FALSE(is_dropped(":INPUT DROP [0:0]\n-A INPUT -s 10.0.0.0/8 -j ACCEPT\n"));
    EXPECT_FALSE(is_dropped(":INPUT DROP [0:0]\n-A INPUT -j unknown_target\n"));
}

// As nft 1.0.6 prints it.
constexpr const char* kChain =
    R"({"nftables": [{"metainfo": {"version": "1.0.6"}}, {"table": {"family": "inet", "name": )"
    R"("filter", "handle": 1}}, {"chain": {"family": "inet", "table": "filter", "name": "input", )"
    R"("handle": 1, "type": "filter", "hook": "input", "prio": 0, "policy": "drop"}}, )"
    R"({"chain": {"family": "inet", "table": "filter", "name": "other", "handle": 9}})";

bool nft_drops(const std::string& expressions, const Datagram& datagram = kDds) {
    const std::string rule =
        R"(, {"rule": {"family": "inet", "table": "filter", "chain": "input", "expr": [)";
    return dropped_by(parse_nft(kChain + rule + expressions + "]}}]}"), datagram) != nullptr;
}

TEST(Firewall, ReadsNftExpressions) {
    const std::string accept = R"(, {"accept": null})";
    const auto match =
        [](const std::string& op, const std::string& left, const std::string& right) {
            return R"({"match": {"op": ")" + op + R"(", "left": )" + left + R"(, "right": )" +
                   right + "}}";
        };
    const std::string port = R"({"payload": {"protocol": "udp", "field": "dport"}})";
    const std::string tcp_port = R"({"payload": {"protocol": "tcp", "field": "dport"}})";
    const std::string any_port = R"({"payload": {"protocol": "th", "field": "dport"}})";
    EXPECT_TRUE(nft_drops(R"({"counter": null})"));
    EXPECT_FALSE(
        nft_drops(match("==", port, R"({"set": [53, {"range": [7400, 7500]}]})") + accept));
    EXPECT_TRUE(nft_drops(match("==", port, R"({"set": [53, {"range": [67, 68]}]})") + accept));
    EXPECT_TRUE(nft_drops(match("!=", port, "7400") + accept));
    EXPECT_TRUE(nft_drops(match("==", tcp_port, "7400") + accept));
    EXPECT_FALSE(
        nft_drops(match("==", R"({"meta": {"key": "l4proto"}})", R"({"set": ["tcp", "udp"]})") +
                  ", " + match("==", any_port, "7400") + accept));
    EXPECT_FALSE(nft_drops(match("==",
                                 R"({"payload": {"protocol": "ip", "field": "daddr"}})",
                                 R"({"prefix": {"addr": "239.0.0.0", "len": 8}})") +
                           accept));
    EXPECT_TRUE(nft_drops(
        match("in", R"({"ct": {"key": "state"}})", R"(["established", "related"])") + accept));
    EXPECT_FALSE(nft_drops(match("==", R"({"meta": {"key": "iifname"}})", R"("eth*")") + accept));
    EXPECT_TRUE(nft_drops(R"({"jump": {"target": "other"}})"));
    EXPECT_FALSE(nft_drops(match("==", R"({"meta": {"key": "mark"}})", "7") + accept));
}

TEST(Firewall, TreatsMapsOfStatesAsUsual) {
    const std::string map =
        R"({"vmap": {"key": {"ct": {"key": "state"}}, "data": {"set": [["invalid", {"drop": null}], )"
        R"(["established", {"accept": null}]]}}})";
    EXPECT_TRUE(nft_drops(map));
    EXPECT_FALSE(nft_drops(R"({"vmap": {"key": {"meta": {"key": "iifname"}}, "data": "@zones"}})"));
}

TEST(Firewall, ReadsNothingFromGarbage) {
    for (const std::string text : {"",
                                   "{",
                                   "[]",
                                   "null",
                                   "{\"nftables\": 3}",
                                   "{\"nftables\": [null, [], {}, {\"rule\": 1}, {\"rule\": {}}]}",
                                   "{\"nftables\": [{\"chain\": {\"family\": 4}}]}"})
        EXPECT_TRUE(parse_nft(text).chains.empty()) << text;
    EXPECT_TRUE(parse_iptables(":INPUT DROP\n-A\n*filter\n:\n-A x\n").chains.empty());
}

}  // namespace
}  // namespace atrium::doctor
