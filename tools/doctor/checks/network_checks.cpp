#include "network_needs.hpp"
#include "tools/doctor/checks/checks.hpp"
#include "tools/doctor/facts/collect.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::doctor {
namespace {

constexpr std::uint32_t kMulticastGroup = 0xEFFF0001;  // 239.255.0.1
constexpr int kSlowMbit = 1000;                        // less than this is slow
// Fewer happen on good cards, at the start of a link for example.
constexpr std::uint64_t kFewPackets = 100;
constexpr double kLostShare = 1e-5;

const Card* card_named(const NetworkFacts& network, const std::string& name) {
    for (const Card& card : network.cards) {
        if (card.name == name) return &card;
    }
    return nullptr;
}

std::string address_of(const Card& card) {
    return card.addresses.empty() ? "" : " (" + address_text(card.addresses.front().address) + ")";
}

// Keeps a setting of the card `name` over a restart.
std::string keep_by_udev(const Card& card, const std::string& action) {
    const std::string match =
        card.mac.empty() ? "KERNEL==\"" + card.name + "\"" : "ATTR{address}==\"" + card.mac + "\"";
    return write_line("ACTION==\"add\", SUBSYSTEM==\"net\", " + match + ", " + action,
                      "/etc/udev/rules.d/90-atrium-" + card.name + ".rules");
}

void check_buffers(const Facts& facts, Findings& findings) {
    const auto small = [&](const char* id,
                           std::optional<std::uint64_t> has,
                           std::uint64_t wanted,
                           const std::string& name,
                           const char* consequence) {
        if (!has || *has >= wanted) return;
        const std::string value = std::to_string(wanted);
        findings.push_back(make_finding(id,
                                        fmt::format("{} is {}; Atrium asks for {}: {}.",
                                                    name,
                                                    size_text(*has),
                                                    size_text(wanted),
                                                    consequence),
                                        set_sysctl(name, value),
                                        keep_sysctl(name, value)));
    };
    small("receive_buffer_small",
          facts.network.rmem_max,
          kReceiveBufferBytes,
          "net.core.rmem_max",
          "packets of a burst are lost");
    if (facts.wishes.network == "loopback") return;
    small("send_buffer_small",
          facts.network.wmem_max,
          kSendBufferBytes,
          "net.core.wmem_max",
          "a site waits while it sends");
    // datagrams of the others fit into one packet
    if (facts.wishes.network == "wifi" || facts.wishes.network == "wan") return;
    if (facts.network.ipfrag_time_s && *facts.network.ipfrag_time_s > kFragmentTime_s) {
        const std::string value = std::to_string(kFragmentTime_s);
        findings.push_back(make_finding(
            "fragments_kept_long",
            fmt::format(
                "net.ipv4.ipfrag_time is {} s; a LAN wants {} s: fragments of lost datagrams "
                "fill the memory for new ones.",
                *facts.network.ipfrag_time_s,
                kFragmentTime_s),
            set_sysctl("net.ipv4.ipfrag_time", value),
            keep_sysctl("net.ipv4.ipfrag_time", value)));
    }
    small("fragment_memory_small",
          facts.network.ipfrag_memory,
          kFragmentMemoryBytes,
          "net.ipv4.ipfrag_high_thresh",
          "fragments of large datagrams are dropped");
}

void check_choice(const Facts& facts, Findings& findings) {
    const NetworkFacts& network = facts.network;
    if (!network.card.empty()) {
        if (!network.is_card_by_chance) return;
        std::string others;
        for (const Card& card : network.cards) {
            if (card.is_up && !card.is_loopback && card.name != network.card)
                others += (others.empty() ? "" : ", ") + card.name;
        }
        findings.push_back(make_finding(
            "card_chosen_by_chance",
            fmt::format("No default route says which network card to use: Atrium takes {}, not {}.",
                        network.card,
                        others),
            fmt::format(
                "{} --network lan --interface {}", path_of_any(facts), shell_word(network.card))));
        return;
    }
    if (!facts.wishes.interface.empty()) {
        findings.push_back(make_finding(
            "card_missing",
            fmt::format("The network card '{}' of bus.interface is missing or down.",
                        facts.wishes.interface),
            fmt::format("sudo ip link set dev {} up", shell_word(facts.wishes.interface))));
        return;
    }
    std::string down;
    bool is_up = false;
    for (const Card& card : network.cards) {
        if (card.is_loopback || (is_up && !card.is_up)) continue;
        is_up |= card.is_up;
        down = card.name;
    }
    if (is_up) {
        findings.push_back(make_finding(
            "no_network_card",
            fmt::format("The network card {} is up, but has no IPv4 address: other hosts are not "
                        "reached.",
                        down),
            fmt::format("sudo dhclient {}", shell_word(down))));
        return;
    }
    findings.push_back(make_finding(
        "no_network_card",
        down.empty()
            ? "This host has no network card but loopback: other hosts are not reached."
            : fmt::format("No network card is up ({} is down): other hosts are not reached.", down),
        down.empty()
            ? path_of_any(facts) + " --network loopback"
            : fmt::format("sudo ip link set dev {0} up && sudo dhclient {0}", shell_word(down))));
}

// Root can read the firewall, and then names the rule. Without multicast, hosts are named.
std::string cure_of_multicast(const Facts& facts) {
    const bool is_readable =
        !facts.network.nft_rules.empty() || !facts.network.iptables_rules.empty();
    if (is_readable) return "atrium monitor --network lan --peers HOST1,HOST2";
    const std::string doctor =
        facts.programs.empty()
            ? "atrium doctor"
            : shell_word((facts.programs.front().path.parent_path() / "doctor").string());
    return "sudo apt install nftables && sudo " + doctor;
}

void check_multicast(const Facts& facts, Findings& findings) {
    const NetworkFacts& network = facts.network;
    const Card* card = card_named(network, network.card);
    if (card == nullptr || facts.wishes.network == "wan") return;
    if (!card->has_multicast) {
        findings.push_back(make_finding(
            "card_without_multicast",
            fmt::format("The network card {}{} does not take part in multicast: programs of other "
                        "hosts are not found.",
                        card->name,
                        address_of(*card)),
            fmt::format("sudo ip link set dev {} multicast on", shell_word(card->name)),
            keep_by_udev(*card, "RUN+=\"/usr/sbin/ip link set dev $name multicast on\"")));
        return;
    }
    const auto leads_to_group = [](const Route& route) {
        return (route.destination & route.mask) == (kMulticastGroup & route.mask);
    };
    if (!network.routes.empty() &&
        std::none_of(network.routes.begin(), network.routes.end(), leads_to_group)) {
        findings.push_back(make_finding(
            "no_multicast_route",
            "No route leads to multicast addresses: programs that do not name a network card "
            "cannot send to them.",
            fmt::format("sudo ip route add 224.0.0.0/4 dev {}", shell_word(card->name))));
    }
    if (network.hears_multicast == false) {
        findings.push_back(make_finding(
            "multicast_not_heard",
            fmt::format("A datagram to 239.255.0.1 port 7400 by {}{} is not heard on this host: a "
                        "firewall or the system stops multicast, and programs do not find each "
                        "other, unless --peers names the hosts.",
                        card->name,
                        address_of(*card)),
            cure_of_multicast(facts)));
    }
}

void check_link(const Facts& facts, const Card& card, const char* use, Findings& findings) {
    const std::string ethtool =
        facts.network.has_ethtool ? "sudo ethtool" : "sudo apt install ethtool && sudo ethtool";
    const std::string name = shell_word(card.name);
    const std::string fast =
        fmt::format("{} -s {} speed 1000 duplex full autoneg on", ethtool, name);
    if (card.is_half_duplex) {
        findings.push_back(make_finding(
            "link_half_duplex",
            fmt::format("The link of {} ({}) is half duplex, {} Mbit/s; it must be full duplex.",
                        card.name,
                        use,
                        card.speed_mbit),
            fast));
    } else if (card.speed_mbit > 0 && card.speed_mbit < kSlowMbit) {
        findings.push_back(make_finding(
            "link_slow",
            fmt::format("The link of {} ({}) has {} Mbit/s; wanted are 1000: check that the cable "
                        "has all four pairs (Cat 5e) and what the switch offers.",
                        card.name,
                        use,
                        card.speed_mbit),
            fast));
    }
    const double all = static_cast<double>(card.received) + static_cast<double>(card.lost);
    const auto is_much = [&](std::uint64_t packets) {
        return packets > kFewPackets && static_cast<double>(packets) > kLostShare * all;
    };
    const auto share = [&](std::uint64_t packets) {
        return fmt::format(
            "{} packets ({:.2g} %)", packets, 100.0 * static_cast<double>(packets) / all);
    };
    const bool may_grow = card.ring && card.ring->now < card.ring->largest;
    if (is_much(card.lost)) {
        findings.push_back(make_finding(
            "card_loses_packets",
            fmt::format(
                "{} ({}) lost {} since the start, because its receive ring was full{}; wanted "
                "are less than 0.001 %.",
                card.name,
                use,
                share(card.lost),
                may_grow || !card.ring ? ""
                                       : ", although it is the largest of the card: lower the rate "
                                         "or share it over more cards"),
            // without ethtool nobody knows how large it may be
            may_grow ? fmt::format("sudo ethtool -G {} rx {}", name, card.ring->largest)
                     : fmt::format("{} -g {}", ethtool, name),
            may_grow ? keep_by_udev(card,
                                    fmt::format("RUN+=\"/usr/sbin/ethtool -G $name rx {}\"",
                                                card.ring->largest))
                     : ""));
    }
    if (is_much(card.damaged)) {
        findings.push_back(make_finding(
            "cable_bad",
            fmt::format("{} ({}) got {} with wrong checksums since the start: replace the cable or "
                        "the switch port, and see whether the count still grows.",
                        card.name,
                        use,
                        share(card.damaged)),
            fmt::format("ip -s -s link show dev {}", name)));
    }
}

void check_subnets(const Facts& facts, Findings& findings) {
    const std::vector<Card>& cards = facts.network.cards;
    for (std::size_t i = 0; i < cards.size(); ++i) {
        for (std::size_t j = i + 1; j < cards.size(); ++j) {
            if (!cards[i].is_up || !cards[j].is_up || cards[i].is_loopback || cards[j].is_loopback)
                continue;
            for (const CardAddress& a : cards[i].addresses) {
                for (const CardAddress& b : cards[j].addresses) {
                    if (!is_in(a, b.address) && !is_in(b, a.address)) continue;
                    const bool keep_first = facts.network.card != cards[j].name;
                    const CardAddress& spare = keep_first ? b : a;
                    findings.push_back(make_finding(
                        "cards_in_one_subnet",
                        fmt::format("{} ({}/{}) and {} ({}/{}) are in one subnet: answers leave by "
                                    "the wrong card; give each card its own subnet.",
                                    a.card,
                                    address_text(a.address),
                                    a.prefix,
                                    b.card,
                                    address_text(b.address),
                                    b.prefix),
                        fmt::format("sudo ip address del {}/{} dev {}",
                                    address_text(spare.address),
                                    spare.prefix,
                                    shell_word(spare.card))));
                    return;
                }
            }
        }
    }
}

}  // namespace

std::uint32_t mask_of(int prefix) {
    return prefix <= 0 ? 0 : prefix >= 32 ? 0xFFFFFFFFU : 0xFFFFFFFFU << (32 - prefix);
}

bool is_in(const CardAddress& network, std::uint32_t address) {
    return ((network.address ^ address) & mask_of(network.prefix)) == 0;
}

const Card* card_towards(const NetworkFacts& network, const std::string& address) {
    const auto wanted = parse_address(address);
    const Card* best = nullptr;
    int best_prefix = 0;
    if (!wanted) return nullptr;
    for (const Card& card : network.cards) {
        for (const CardAddress& own : card.addresses) {
            if (!is_in(own, *wanted) || own.prefix <= best_prefix) continue;
            best = &card;
            best_prefix = own.prefix;
        }
    }
    return best;
}

Findings check_network(const Facts& facts) {
    Findings findings;
    check_buffers(facts, findings);
    const std::vector<const Card*> with_cameras = camera_cards(facts);
    for (const Card* card : with_cameras) {
        if (!card->is_loopback) check_link(facts, *card, "cameras", findings);
    }
    if (facts.wishes.network == "loopback") return findings;
    check_choice(facts, findings);
    check_multicast(facts, findings);
    const Card* card = card_named(facts.network, facts.network.card);
    if (card != nullptr &&
        std::find(with_cameras.begin(), with_cameras.end(), card) == with_cameras.end())
        check_link(facts, *card, "other hosts", findings);
    check_subnets(facts, findings);
    return findings;
}

}  // namespace atrium::doctor
