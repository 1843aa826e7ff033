#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <string>
#include <vector>

/// What `BusOptions` say of the network, as the settings that Cyclone DDS takes.
namespace atrium::bus {

/// A network card with an IPv4 address.
struct NetworkCard {
    std::string name;
    std::string address;
    bool is_up = false;
    bool is_loopback = false;
};

struct NetworkSettings {
    std::string xml;     // for dds_create_domain
    std::string source;  // names it in errors: "network lan", or the file
    std::string kind;    // loopback, lan, wifi, wan, or the file
    std::string card;    // name; empty: the file leaves it to Cyclone
    std::string address;
    bool multicast = false;                // programs are found by it
    std::vector<std::string> peers;        // IPv4 addresses, those of the file as they stand there
    bool has_remote_peers = false;         // given as an option, not this host
    std::size_t receive_buffer_bytes = 0;  // asked for
};

/// Of this host.
std::vector<NetworkCard> network_cards();

/// Reads the file, built in or not, and enters peers and card. Fails with kConfiguration naming a
/// peer that cannot be resolved or a card that is not there or not up, kNotFound for a file.
Expected<NetworkSettings> load_network_settings(const BusOptions& options);

/// Asks the kernel what it grants a socket that asks for so much, and puts into words how this
/// process is on the network.
NetworkReport report_network(const NetworkSettings& settings);

}  // namespace atrium::bus
