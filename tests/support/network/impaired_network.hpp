#pragma once

#include "core/base/expected.hpp"
#include "tests/support/network/hosted_process.hpp"
#include "tests/support/network/network_host.hpp"
#include "tests/support/network/packet_relay.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace atrium::test {

/// Hosts with the addresses 10.77.0.1, 10.77.0.2 ... around a hub. Each has its own line, whose
/// impairments can change while programs run. Carries unicast and multicast of IPv4. Needs no
/// rights and no kernel module except tun. Nothing is left after this object or process ends.
///
/// It uses TUN devices, not TAP. Without ARP, no lost ARP packet delays the first packet of a test
/// by a second, and multicast needs only a route, not a bridge.
class ImpairedNetwork {
public:
    /// 2 to 8 hosts. Error kUnavailable if namespaces or /dev/net/tun are not permitted.
    static Expected<std::unique_ptr<ImpairedNetwork>> create(int num_hosts, std::uint64_t seed);

    std::string address(int host) const;

    /// All lines start without impairments.
    void set(int host, Way way, const Impairment& impairment) {
        relay_->set(host, way, impairment);
    }
    /// Pulls the cable of a host, and plugs it in again.
    void cut(int host);
    void restore(int host);
    LineCounters counters(int host, Way way) const { return relay_->counters(host, way); }
    PacketRelay& relay() { return *relay_; }

    Expected<std::unique_ptr<HostedProcess>> start(int host,
                                                   const std::vector<std::string>& command) const;
    Expected<std::unique_ptr<Descriptor>> udp_socket(int host, std::uint16_t port) const;

private:
    ImpairedNetwork() = default;
    std::vector<NetworkHost> hosts_;  // without their TUN devices, which the relay owns
    std::unique_ptr<PacketRelay> relay_;
};

}  // namespace atrium::test
