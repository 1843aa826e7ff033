#include "tests/integration/security/sniffer.hpp"

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace atrium::test {
namespace {

constexpr std::size_t kIpv4Header = 20;
constexpr std::size_t kUdpHeader = 8;
constexpr std::uint8_t kUdp = 17;

}  // namespace

Expected<std::unique_ptr<Sniffer>> Sniffer::start() {
    const int socket = ::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP));
    if (socket < 0) return make_error(ErrorKind::kUnavailable, std::strerror(errno));
    sockaddr_ll on_loopback{};
    on_loopback.sll_family = AF_PACKET;
    on_loopback.sll_protocol = htons(ETH_P_IP);
    on_loopback.sll_ifindex = static_cast<int>(::if_nametoindex("lo"));
    const int size = 64 << 20;
    const timeval patience{0, 50'000};
    ::setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size);
    ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (::bind(socket, reinterpret_cast<const sockaddr*>(&on_loopback), sizeof on_loopback) != 0) {
        ::close(socket);
        return make_error(ErrorKind::kUnavailable, std::strerror(errno));
    }
    return std::unique_ptr<Sniffer>(new Sniffer(socket));
}

Sniffer::Sniffer(int socket) : socket_(socket), thread_([this] { collect(); }) {}

Sniffer::~Sniffer() {
    ends_ = true;
    thread_.join();
    ::close(socket_);
}

std::vector<std::vector<std::uint8_t>> Sniffer::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(datagrams_, {});
}

void Sniffer::collect() {
    std::vector<std::uint8_t> packet(1U << 16U);
    while (!ends_) {
        const ssize_t size = ::recv(socket_, packet.data(), packet.size(), 0);
        if (size < static_cast<ssize_t>(kIpv4Header + kUdpHeader) || packet[9] != kUdp) continue;
        const std::lock_guard lock(mutex_);
        datagrams_.emplace_back(packet.begin() + kIpv4Header + kUdpHeader, packet.begin() + size);
    }
}

}  // namespace atrium::test
