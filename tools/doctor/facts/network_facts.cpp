#include "tools/doctor/facts/collect.hpp"

#include <arpa/inet.h>
#include <net/if.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace atrium::doctor {
namespace {

constexpr std::size_t kMaxCards = 256;

std::optional<std::uint32_t> parse_hex(const std::string& text) {
    const std::size_t skip = text.rfind("0x", 0) == 0 ? 2 : 0;
    std::uint32_t number = 0;
    const char* last = text.data() + text.size();
    const auto [end, failure] = std::from_chars(text.data() + skip, last, number, 16);
    if (failure != std::errc() || end != last) return std::nullopt;
    return number;
}

std::optional<Card> read_card(const System& system, const std::string& name) {
    const std::string folder = "/sys/class/net/" + name + "/";
    const auto flags = parse_hex(system.read_word(folder + "flags").value_or(""));
    if (!flags) return std::nullopt;
    const auto number = [&](const std::string& file) {
        return system.read_number(folder + file).value_or(0);
    };
    const auto small_number = [&](const std::string& file) {
        return static_cast<int>(std::min<std::uint64_t>(number(file), 10'000'000));
    };
    Card card;
    card.name = name;
    card.mac = system.read_word(folder + "address").value_or("");
    card.is_up = (*flags & IFF_UP) != 0;
    card.is_loopback = (*flags & IFF_LOOPBACK) != 0;
    card.has_multicast = (*flags & IFF_MULTICAST) != 0;
    card.is_wired = system.exists(folder + "device") && !system.exists(folder + "wireless") &&
                    !system.exists(folder + "phy80211");
    card.mtu = small_number("mtu");
    card.speed_mbit = small_number("speed");  // "-1" without a link: no number
    card.is_half_duplex = system.read_word(folder + "duplex") == "half";
    card.received = number("statistics/rx_packets");
    // drivers count the same packets under one name or both
    card.lost =
        std::max(number("statistics/rx_missed_errors"), number("statistics/rx_fifo_errors"));
    card.damaged =
        std::max(number("statistics/rx_crc_errors"), number("statistics/rx_frame_errors"));
    const auto filter = [&](const std::string& of) {
        return system.read_number("/proc/sys/net/ipv4/conf/" + of + "/rp_filter").value_or(0);
    };
    card.rp_filter =
        static_cast<int>(std::min<std::uint64_t>(2, std::max(filter("all"), filter(name))));
    return card;
}

// `ethtool -g`: what may be, then what is.
std::optional<ReceiveRing> receive_ring(const System& system, const std::string& card) {
    const auto output = system.run({"ethtool", "-g", card});
    if (!output || output->exit_code != 0) return std::nullopt;
    std::vector<std::uint64_t> sizes;
    for (const std::string& line : lines_of(output->text)) {
        const std::vector<std::string> words = words_of(line);
        if (words.size() != 2 || words[0] != "RX:") continue;
        const auto size = parse_number(words[1]);
        if (!size) return std::nullopt;
        sizes.push_back(*size);
    }
    if (sizes.size() != 2) return std::nullopt;
    return ReceiveRing{.now = sizes[1], .largest = sizes[0]};
}

std::vector<Card> read_cards(const System& system) {
    std::vector<Card> cards;
    const auto addresses = system.card_addresses().value_or(std::vector<CardAddress>{});
    for (const std::string& name : system.names_in("/sys/class/net")) {
        if (!system.has_card(name)) continue;
        auto card = read_card(system, name);
        if (!card) continue;
        std::copy_if(addresses.begin(),
                     addresses.end(),
                     std::back_inserter(card->addresses),
                     [&](const CardAddress& one) { return one.card == name; });
        if (card->is_wired && card->lost > 0) card->ring = receive_ring(system, name);
        cards.push_back(std::move(*card));
        if (cards.size() >= kMaxCards) break;
    }
    return cards;
}

std::vector<Route> read_routes(const System& system) {
    std::vector<Route> routes;
    for (const std::string& line : lines_of(system.read("/proc/net/route").value_or(""))) {
        const std::vector<std::string> words = words_of(line);
        if (words.size() < 8) continue;
        const auto destination = parse_hex(words[1]);
        const auto mask = parse_hex(words[7]);
        // the kernel prints the bytes of the network in the order of this processor
        if (destination && mask) routes.push_back({words[0], ntohl(*destination), ntohl(*mask)});
    }
    return routes;
}

bool is_usable(const Card& card, bool are_addresses_known) {
    return card.is_up && !card.is_loopback && (!are_addresses_known || !card.addresses.empty());
}

// As core/bus chooses it.
void choose_card(const Wishes& wishes, bool are_addresses_known, NetworkFacts& network) {
    std::vector<std::string> usable;
    for (const Card& card : network.cards) {
        if (card.name == wishes.interface && card.is_up) network.card = card.name;
        if (is_usable(card, are_addresses_known)) usable.push_back(card.name);
    }
    if (!wishes.interface.empty() || usable.empty()) return;
    const auto default_route =
        std::find_if(network.routes.begin(), network.routes.end(), [&](const Route& route) {
            return route.mask == 0 &&
                   std::find(usable.begin(), usable.end(), route.card) != usable.end();
        });
    const bool has_route = default_route != network.routes.end();
    network.card = has_route ? default_route->card : usable.front();
    network.is_card_by_chance = !has_route && usable.size() > 1;
}

std::string nft_json(const System& system) {
    const auto output = system.run({"nft", "-j", "list", "ruleset"});
    if (!output || output->exit_code != 0) return "";
    // warnings stand on lines of their own
    for (const std::string& line : lines_of(output->text)) {
        if (line.rfind("{\"nftables\"", 0) == 0) return line;
    }
    return "";
}

}  // namespace

std::optional<std::uint32_t> parse_address(const std::string& text) {
    in_addr address{};
    if (inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
    return ntohl(address.s_addr);
}

std::string address_text(std::uint32_t address) {
    const in_addr network_order{htonl(address)};
    std::array<char, INET_ADDRSTRLEN> text{};
    return inet_ntop(AF_INET, &network_order, text.data(), text.size()) == nullptr ? ""
                                                                                   : text.data();
}

NetworkFacts collect_network(const System& system, const Wishes& wishes) {
    NetworkFacts network;
    network.rmem_max = system.read_number("/proc/sys/net/core/rmem_max");
    network.wmem_max = system.read_number("/proc/sys/net/core/wmem_max");
    network.ipfrag_time_s = system.read_number("/proc/sys/net/ipv4/ipfrag_time");
    network.ipfrag_memory = system.read_number("/proc/sys/net/ipv4/ipfrag_high_thresh");
    network.cards = read_cards(system);
    network.routes = read_routes(system);
    choose_card(wishes, system.card_addresses().has_value(), network);
    network.nft_rules = nft_json(system);
    const auto iptables = system.run({"iptables-save"});
    if (iptables && iptables->exit_code == 0) network.iptables_rules = iptables->text;
    // a copy of a host may lack its programs
    network.has_ethtool = !system.exists("/usr/sbin") || system.exists("/usr/sbin/ethtool");
    for (const std::string& line : lines_of(system.read("/etc/ufw/ufw.conf").value_or("")))
        network.has_ufw |= line == "ENABLED=yes";
    for (const Card& card : network.cards) {
        if (card.name != network.card || !card.has_multicast || card.addresses.empty()) continue;
        network.hears_multicast = system.hears_multicast(card.addresses.front().address);
    }
    return network;
}

}  // namespace atrium::doctor
