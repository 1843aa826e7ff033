#include "tools/doctor/checks/checks.hpp"
#include "tools/doctor/checks/firewall_rules.hpp"
#include "tools/doctor/facts/collect.hpp"

#include <fmt/format.h>

namespace atrium::doctor {
namespace {

constexpr std::uint32_t kGroup = 0xEFFF0001;  // 239.255.0.1, by which programs find each other
constexpr std::uint32_t kFirstPort = 7400;
constexpr std::uint32_t kPortsPerDomain = 250;
constexpr std::uint32_t kCameraPort = 3956;
constexpr std::uint32_t kOwnPort = 45'678;  // the kernel gives programs a port above 32767

constexpr const char* kNftFile = "/etc/nftables.conf";

struct Opening {
    std::string nft;  // conditions of a rule
    std::string iptables;
    std::string ufw;  // after "ufw allow"
    std::string firewalld;
};

Finding found_drop(const Facts& facts,
                   const RuleSet& rules,
                   const Chain& chain,
                   const char* id,
                   const std::string& text,
                   const Opening& opening) {
    if (facts.network.has_ufw)
        return make_finding(id, text, fmt::format("sudo ufw allow {}", opening.ufw));
    if (rules.has_firewalld) {
        return make_finding(id,
                            text,
                            fmt::format("sudo firewall-cmd --permanent {} && "
                                        "sudo firewall-cmd --reload",
                                        opening.firewalld));
    }
    // the table that iptables-nft makes is for iptables only
    const bool is_of_iptables =
        chain.family.empty() ||
        (chain.family == "ip" && chain.table == "filter" && chain.name == "INPUT");
    if (is_of_iptables) {
        return make_finding(
            id,
            text,
            fmt::format("sudo iptables -I INPUT {} -j ACCEPT", opening.iptables),
            "sudo apt install iptables-persistent && sudo netfilter-persistent save");
    }
    const std::string rule = fmt::format("insert rule {} {} {} {} accept",
                                         chain.family,
                                         shell_word(chain.table),
                                         shell_word(chain.name),
                                         opening.nft);
    // A rule for a table that the file lacks would stop all of it: it is checked before it is kept.
    return make_finding(id,
                        text,
                        "sudo nft " + rule,
                        fmt::format("(cat {1}; echo {0}) | sudo nft -c -f - && echo {0} | sudo "
                                    "tee -a {1} && sudo systemctl enable nftables",
                                    shell_word(rule),
                                    kNftFile));
}

std::string place_of(const Chain& chain) {
    if (chain.family.empty()) return fmt::format("iptables, chain {}", chain.name);
    return fmt::format("nftables, chain {} {} {}", chain.family, chain.table, chain.name);
}

void check_dds_ports(const Facts& facts, const RuleSet& rules, Findings& findings) {
    if (facts.wishes.network == "loopback") return;
    const std::uint32_t first = kFirstPort + kPortsPerDomain * facts.wishes.domain;
    const std::uint32_t last = first + kPortsPerDomain - 1;
    // by multicast; then discovery and data of the first two programs of a host
    for (const std::uint32_t offset : {0U, 10U, 11U, 12U, 13U}) {
        const Datagram datagram{.to = offset == 0 ? kGroup : 0,
                                .from_port = kOwnPort,
                                .to_port = first + offset,
                                .card = facts.network.card};
        const Chain* chain = dropped_by(rules, datagram);
        if (chain == nullptr) continue;
        findings.push_back(found_drop(
            facts,
            rules,
            *chain,
            "firewall_drops_dds",
            fmt::format("The firewall ({}) drops UDP to port {}; programs of other hosts are found "
                        "and heard through ports {} to {}.",
                        place_of(*chain),
                        datagram.to_port,
                        first,
                        last),
            {.nft = fmt::format("udp dport {}-{}", first, last),
             .iptables = fmt::format("-p udp --dport {}:{}", first, last),
             .ufw = fmt::format("{}:{}/udp", first, last),
             .firewalld = fmt::format("--add-port={}-{}/udp", first, last)}));
        return;
    }
}

// Cameras send pictures from any port. "": unknown.
std::string network_of_cameras(const Facts& facts, const Card& card) {
    const CardAddress* own = card.addresses.empty() ? nullptr : &card.addresses.front();
    for (const FoundCamera& camera : facts.cameras.found.value_or(std::vector<FoundCamera>{})) {
        const auto address = parse_address(camera.address);
        for (const CardAddress& one : card.addresses) {
            if (address && is_in(one, *address)) own = &one;
        }
    }
    if (own == nullptr) return "";
    return fmt::format("{}/{}", address_text(own->address & mask_of(own->prefix)), own->prefix);
}

std::string rule_of_firewalld(const std::string& network) {
    const std::string from =
        network.empty() ? "" : fmt::format("family=\"ipv4\" source address=\"{}\" ", network);
    return fmt::format("rule {}protocol value=\"udp\" accept", from);
}

void check_camera_port(const Facts& facts, const RuleSet& rules, Findings& findings) {
    const std::vector<const Card*> cards = camera_cards(facts);
    const Card* at = cards.empty() ? likely_camera_card(facts) : cards.front();
    const std::string card = at == nullptr ? "" : at->name;
    const Datagram datagram{.to = 0, .from_port = kCameraPort, .to_port = kOwnPort, .card = card};
    const Chain* chain = dropped_by(rules, datagram);
    if (chain == nullptr) return;
    const std::string name = shell_word(card);
    const std::string network = at == nullptr ? "" : network_of_cameras(facts, *at);
    const bool opens_others = card.empty() || card == facts.network.card;
    findings.push_back(found_drop(
        facts,
        rules,
        *chain,
        "firewall_drops_cameras",
        fmt::format("The firewall ({}) drops UDP from port {}: answers and pictures of GigE Vision "
                    "cameras do not arrive.{}",
                    place_of(*chain),
                    kCameraPort,
                    opens_others ? " The command lets UDP of other hosts in, too." : ""),
        {.nft =
             card.empty() ? "meta l4proto udp" : fmt::format("iifname {} meta l4proto udp", name),
         .iptables = card.empty() ? "-p udp" : fmt::format("-i {} -p udp", name),
         .ufw = card.empty() ? "proto udp from any" : fmt::format("in on {} proto udp", name),
         .firewalld = "--add-rich-rule=" + shell_word(rule_of_firewalld(network))}));
}

}  // namespace

Findings check_firewall(const Facts& facts) {
    Findings findings;
    const auto check_rules = [&](const RuleSet& rules) {
        check_dds_ports(facts, rules, findings);
        if (facts.roles.camera) check_camera_port(facts, rules, findings);
    };
    check_rules(parse_nft(facts.network.nft_rules));
    // iptables of today writes nftables rules: only the older one is left
    if (findings.empty()) check_rules(parse_iptables(facts.network.iptables_rules));
    return findings;
}

}  // namespace atrium::doctor
