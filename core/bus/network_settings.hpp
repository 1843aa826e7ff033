#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <string>
#include <vector>

/// Turns `BusOptions` into the settings of Cyclone DDS.
namespace atrium::bus {

/// A network card with an IPv4 address.
struct NetworkCard {
    std::string name;
    std::string address;
    bool is_up = false;
    bool is_loopback = false;
};

struct NetworkSettings {
    std::string xml;                 // for dds_create_domain
    std::string source;              // names the settings in errors: "network lan", or the file
    std::string kind;                // loopback, lan, wifi, wan, or the file
    std::string card;                // name; empty: the file leaves it to Cyclone
    std::string address;             // of the card, IPv4; empty: unknown
    bool multicast = false;          // discovery uses multicast
    std::vector<std::string> peers;  // IPv4 addresses; those of the file unchanged
    bool has_remote_peers = false;   // the option bus.peers names another host
    std::vector<std::string> unreachable_peers;  // left out: loopback cannot reach these hosts
    std::size_t receive_buffer_bytes = 0;        // requested size
    bool is_secured = false;                     // only programs with keys can join
};

/// Lists the cards of this host that have an IPv4 address.
std::vector<NetworkCard> network_cards();

/// Reads the embedded or given file and enters peers and card. Fails with kConfiguration for a peer
/// that cannot be resolved and for a card that is missing or down, and as load_network_file does.
Expected<NetworkSettings> load_network_settings(const BusOptions& options);

/// Describes the settings for the log, with warnings. Asks the kernel which receive buffer it
/// grants.
NetworkReport report_network(const NetworkSettings& settings);

}  // namespace atrium::bus
