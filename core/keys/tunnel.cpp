#include "core/keys/tunnel.hpp"

#include "core/base/fnv1a.hpp"
#include "core/base/valid_name.hpp"
#include "core/keys/member.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>

namespace atrium::keys {
namespace {

constexpr int kKeepalive_s = 25;  // shorter than what NAT remembers

std::optional<int> number_in(std::string_view text, int min, int max) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_plain = std::to_string(value) == text;
    if (error != std::errc() || end != text.data() + text.size() || !is_plain) return std::nullopt;
    return value >= min && value <= max ? std::optional(value) : std::nullopt;
}

// "10.A.B.C" with C in 1..254
bool is_address(std::string_view text) {
    constexpr std::string_view kBegin = "10.";
    if (!text.starts_with(kBegin)) return false;
    text.remove_prefix(kBegin.size());
    for (int i = 0; i < 2; ++i) {
        const std::size_t dot = text.find('.');
        if (dot == std::string_view::npos || !number_in(text.substr(0, dot), 0, 255)) return false;
        text.remove_prefix(dot + 1);
    }
    return number_in(text, 1, 254).has_value();
}

std::string subnet_of(const std::string& address) {
    return address.substr(0, address.rfind('.')) + ".0/24";
}

tl::unexpected<Error> damaged_tunnel(const std::string& what) {
    return make_error(ErrorKind::kInvalidData, "its tunnel has " + what);
}

}  // namespace

std::string Tunnel::subnet() const { return subnet_of(places.front().address); }

const Place& Tunnel::own() const { return *std::ranges::find(places, name, &Place::name); }

Expected<std::string> parse_hub(const std::string& text) {
    const auto colon = text.find(':');
    const std::string host = text.substr(0, colon);
    const bool is_host = is_valid_name(host) || (host.size() > 63 && host.size() <= 253 &&
                                                 std::ranges::all_of(host, is_name_character));
    // "http://HOST" has no wrong port
    const bool is_url = text.find('/') != std::string::npos;
    if (!is_host || is_url || host.front() == '.' || host.front() == '-')
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("hub: '{}' must be HOST or HOST:PORT, with the name or IPv4 "
                                      "address that others reach over the internet",
                                      text));
    if (colon == std::string::npos) return fmt::format("{}:{}", host, kTunnelPort);
    if (!number_in(text.substr(colon + 1), 1, 65535))
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("hub: the port of '{}' must be in 1..65535", text));
    return text;
}

std::uint16_t port_of_hub(const std::string& hub) {
    const auto port = number_in(std::string_view(hub).substr(hub.find(':') + 1), 1, 65535);
    return static_cast<std::uint16_t>(port.value_or(kTunnelPort));
}

std::string tunnel_card(std::string_view world) {
    // 15 characters in all
    if (world.size() <= 12) return "wg-" + std::string(world);
    Fnv1a hash;
    hash.add(world);
    return fmt::format("wg-{}-{:04x}", world.substr(0, 7), hash.value() & 0xffffU);
}

std::string tunnel_text(const Tunnel& tunnel) {
    std::string text =
        fmt::format("\n[tunnel]\nhub = \"{}\"\nname = \"{}\"\nprivate_key = \"{}\"\n",
                    tunnel.hub,
                    tunnel.name,
                    tunnel.private_key);
    for (const Place& place : tunnel.places)
        text += fmt::format(
            "\n[[tunnel.place]]\nname = \"{}\"\naddress = \"{}\"\npublic_key = \"{}\"\n",
            place.name,
            place.address,
            place.public_key);
    return text;
}

Expected<Tunnel> read_tunnel(config::TableReader& table) {
    Tunnel tunnel;
    table.read("hub", tunnel.hub);
    table.read("name", tunnel.name);
    table.read("private_key", tunnel.private_key);
    std::set<std::string> names;
    std::set<std::string> addresses;
    for (config::TableReader& entry : table.tables("place")) {
        Place place;
        entry.read("name", place.name);
        entry.read("address", place.address);
        entry.read("public_key", place.public_key);
        if (!check_key_name(place.name, "a place")) return damaged_tunnel("a place without a name");
        if (!is_address(place.address) ||
            (!tunnel.places.empty() && subnet_of(place.address) != tunnel.subnet()))
            return damaged_tunnel("a wrong address");
        if (!is_tunnel_key(place.public_key)) return damaged_tunnel("a damaged public key");
        if (!names.insert(place.name).second || !addresses.insert(place.address).second)
            return damaged_tunnel("two places with the same name or address");
        tunnel.places.push_back(std::move(place));
    }
    const auto hub = parse_hub(tunnel.hub);
    if (!hub || *hub != tunnel.hub) return damaged_tunnel("no address of the hub");
    if (!is_tunnel_key(tunnel.private_key)) return damaged_tunnel("a damaged private key");
    if (!names.contains(tunnel.name)) return damaged_tunnel("no place with its own name");
    if (tunnel.places.size() > kMaxPlaces) return damaged_tunnel("too many places");
    return tunnel;
}

std::string wireguard_text(const Tunnel& tunnel) {
    std::string text = fmt::format("[Interface]\nPrivateKey = {}\n", tunnel.private_key);
    if (tunnel.is_hub()) {
        text += fmt::format("ListenPort = {}\n", port_of_hub(tunnel.hub));
        for (std::size_t i = 1; i < tunnel.places.size(); ++i)
            text += fmt::format("\n[Peer]\nPublicKey = {}\nAllowedIPs = {}/32\n",
                                tunnel.places[i].public_key,
                                tunnel.places[i].address);
        return text;
    }
    const Place& hub = tunnel.places.front();
    text += fmt::format(
        "\n[Peer]\nPublicKey = {}\nEndpoint = {}\nAllowedIPs = {}\nPersistentKeepalive = {}\n",
        hub.public_key,
        tunnel.hub,
        tunnel.subnet(),
        kKeepalive_s);
    return text;
}

}  // namespace atrium::keys
