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
    set.add("bus.network_file",
            options.network_file,
            "Cyclone DDS network file, as in qos/; none: this host only");
    set.add("bus.profiles_file",
            options.profiles_file,
            "QoS profiles; none: those of qos/profiles.xml built in");
}

}  // namespace atrium::bus
