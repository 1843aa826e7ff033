#include "tests/support/network/impaired_network.hpp"

#include <fmt/format.h>

#include <cassert>
#include <utility>

namespace atrium::test {
namespace {

constexpr std::uint32_t kNetwork = (10U << 24U) | (77U << 16U);  // 10.77.0.0

}  // namespace

Expected<std::unique_ptr<ImpairedNetwork>> ImpairedNetwork::create(int num_hosts,
                                                                   std::uint64_t seed) {
    assert(num_hosts >= 2 && num_hosts <= 8);
    std::unique_ptr<ImpairedNetwork> network(new ImpairedNetwork);
    std::vector<PacketRelay::Port> ports;
    for (int i = 0; i < num_hosts; ++i) {
        auto host = make_network_host(kNetwork + static_cast<std::uint32_t>(i) + 1);
        if (!host) return tl::unexpected(host.error());
        ports.push_back({std::move(host->tun), host->address});
        network->hosts_.push_back(std::move(*host));
    }
    network->relay_ = std::make_unique<PacketRelay>(std::move(ports), seed);
    return network;
}

std::string ImpairedNetwork::address(int host) const {
    return fmt::format("10.77.0.{}", hosts_[static_cast<std::size_t>(host)].address & 0xffU);
}

void ImpairedNetwork::cut(int host) {
    relay_->cut(host, Way::kUp);
    relay_->cut(host, Way::kDown);
}

void ImpairedNetwork::restore(int host) {
    relay_->restore(host, Way::kUp);
    relay_->restore(host, Way::kDown);
}

Expected<std::unique_ptr<HostedProcess>> ImpairedNetwork::start(
    int host, const std::vector<std::string>& command) const {
    return HostedProcess::start(hosts_[static_cast<std::size_t>(host)], command);
}

Expected<std::unique_ptr<Descriptor>> ImpairedNetwork::udp_socket(int host,
                                                                  std::uint16_t port) const {
    return open_udp_socket(hosts_[static_cast<std::size_t>(host)], port);
}

}  // namespace atrium::test
