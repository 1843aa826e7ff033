#include "core/bus/bus_options.hpp"

#include "core/bus/limits.hpp"

namespace atrium::bus {

void declare(BusOptions& options, config::OptionSet& set) {
    set.add("bus.world",
            options.world,
            "name of the shared world; programs of different worlds do not exchange data");
    set.add_alias("world");
    set.add("bus.domain",
            options.domain,
            "DDS domain; each domain uses its own UDP ports",
            {0, kMaxDomain});
    set.add_word_or_path("bus.network",
                         options.network,
                         "network of the other programs: loopback (this host), lan (wired), wifi, "
                         "wan (routed), or the path of a Cyclone DDS file",
                         {"loopback", "lan", "wifi", "wan"});
    set.add_alias("network");
    set.add("bus.peers",
            options.peers,
            "additional hosts to discover, \"a,b\"; for wan and networks without multicast");
    set.add_alias("peers");
    set.add("bus.interface",
            options.interface,
            "network card, for example eth0; empty: the card of the default route");
    set.add_alias("interface");
    set.add("bus.profiles_file",
            options.profiles_file,
            "QoS profiles (DDS-XML); empty: the built-in copy of qos/profiles.xml");
}

}  // namespace atrium::bus
