#pragma once

#include "core/base/expected.hpp"
#include "tests/support/hosted_process.hpp"
#include "tests/support/network_host.hpp"
#include "tests/support/packet_relay.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace atrium::test {

/// Hosts with the addresses 10.77.0.1, 10.77.0.2 ... around a hub, each on a line of its own that
/// can be made as bad as wanted while programs run. Carries unicast and multicast of IPv4. Needs no
/// rights and no module of the kernel but tun; nothing is left when it, or this process, is gone.
///
/// TUN devices, not TAP: there is no ARP, whose loss would make the first packet of a test wait a
/// second, and multicast needs no bridge, only a route.
class ImpairedNetwork {
public:
    /// 2 to 8 hosts. Error kUnavailable where namespaces or /dev/net/tun are not permitted.
    static Expected<std::unique_ptr<ImpairedNetwork>> create(int num_hosts, std::uint64_t seed);

    std::string address(int host) const;

    /// Both lines of all hosts are free of impairments at first.
    void set(int host, Way way, const Impairment& impairment) {
        relay_->set(host, way, impairment);
    }
    /// A host's cable is pulled, and plugged in again.
    void cut(int host);
    void restore(int host);
    LineCounters counters(int host, Way way) const { return relay_->counters(host, way); }
    PacketRelay& relay() { return *relay_; }

    Expected<std::unique_ptr<HostedProcess>> start(int host,
                                                   const std::vector<std::string>& command) const;
    Expected<std::unique_ptr<Descriptor>> udp_socket(int host, std::uint16_t port) const;

private:
    ImpairedNetwork() = default;
    std::vector<NetworkHost> hosts_;  // without their TUN devices, which the relay has
    std::unique_ptr<PacketRelay> relay_;
};

}  // namespace atrium::test
