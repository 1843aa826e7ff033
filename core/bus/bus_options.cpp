#include "core/bus/bus_options.hpp"

namespace atrium::bus {

void declare(BusOptions& options, config::OptionSet& set) {
    set.add("bus.world",
            options.world,
            "name of the shared world; programs of different worlds do not hear each other");
    set.add("bus.domain",
            options.domain,
            "DDS domain; use another one to keep ports apart on one network",
            {0, 230});
    set.add_word_or_path("bus.network",
                         options.network,
                         "where the other programs are: on this host, on a wired network, on WiFi, "
                         "elsewhere, or as a Cyclone DDS file says",
                         {"loopback", "lan", "wifi", "wan"});
    set.also_called("network");
    set.add("bus.peers",
            options.peers,
            "hosts to look for besides, \"a,b\"; with wan, and where multicast does not pass");
    set.also_called("peers");
    set.add("bus.interface",
            options.interface,
            "network card, such as eth0; empty: that of the default route");
    set.also_called("interface");
    set.add("bus.profiles_file",
            options.profiles_file,
            "QoS profiles; none: those of qos/profiles.xml built in");
}

}  // namespace atrium::bus
