#pragma once

#include "core/base/expected.hpp"
#include "core/config/table_reader.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// A WireGuard tunnel between the places of a world: one hub, with the world server, and a spoke at
/// each other place. Packets between two spokes go through the hub.
namespace atrium::keys {

inline constexpr std::uint16_t kTunnelPort = 51820;
/// An address per place: 1 (the hub) to 254.
inline constexpr std::size_t kMaxPlaces = 254;

/// A key of WireGuard (Curve25519), in base64.
struct TunnelKeys {
    std::string private_key;
    std::string public_key;
};
/// Fails with kInternal.
Expected<TunnelKeys> make_tunnel_keys();
/// True for the base64 text of 32 bytes.
bool is_tunnel_key(std::string_view text);

/// The first three numbers of the addresses of a new tunnel, "10.83.17", by chance.
Expected<std::string> draw_subnet();

/// One end of the tunnel: the place of a member.
struct Place {
    std::string name;  // of the member
    std::string address;
    std::string public_key;
};

/// What one place needs to know.
struct Tunnel {
    std::string hub;            // "HOST:PORT" that all others reach over the internet
    std::string name;           // of this place
    std::string private_key;    // of this place. Never log it
    std::vector<Place> places;  // first the hub, with this place

    bool is_hub() const { return !places.empty() && places.front().name == name; }
    const Place& own() const;
    std::string subnet() const;  // of all places, "10.83.17.0/24"
};

/// "HOST" or "HOST:PORT" as "HOST:PORT". kConfiguration if it is no name or IPv4 address.
Expected<std::string> parse_hub(const std::string& text);
std::uint16_t port_of_hub(const std::string& hub);

/// The network card of a world's tunnel, at most 15 characters: "wg-WORLD", or a short form of it.
std::string tunnel_card(std::string_view world);

/// The table [tunnel] of a bundle, and back. `read_tunnel` takes untrusted values: kInvalidData
/// with one sentence that quotes none of them.
std::string tunnel_text(const Tunnel& tunnel);
Expected<Tunnel> read_tunnel(config::TableReader& table);

/// The configuration for `wg setconf`: the hub has all spokes as peers, a spoke has the hub.
std::string wireguard_text(const Tunnel& tunnel);

}  // namespace atrium::keys
