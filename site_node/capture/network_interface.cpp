#include "site_node/capture/network_interface.hpp"

#include "core/base/descriptor.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <array>
#include <cstring>
#include <fstream>

namespace atrium::capture {
namespace {

constexpr int kUsualMtu = 1500;

std::string text(const in_addr& address) {
    std::array<char, INET_ADDRSTRLEN> buffer{};
    return inet_ntop(AF_INET, &address, buffer.data(), buffer.size()) == nullptr ? ""
                                                                                 : buffer.data();
}

}  // namespace

std::string own_address_towards(const std::string& address) {
    sockaddr_in target{};
    target.sin_family = AF_INET;
    target.sin_port = htons(9);  // any port: nothing is sent
    const Descriptor handle(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in own{};
    socklen_t size = sizeof(own);
    if (handle.get() < 0 || inet_pton(AF_INET, address.c_str(), &target.sin_addr) != 1 ||
        connect(handle.get(), reinterpret_cast<const sockaddr*>(&target), sizeof(target)) != 0 ||
        getsockname(handle.get(), reinterpret_cast<sockaddr*>(&own), &size) != 0) {
        return "";
    }
    return text(own.sin_addr);
}

int mtu_of_interface(const std::string& own_address) {
    ifaddrs* list = nullptr;
    if (getifaddrs(&list) != 0) return kUsualMtu;
    std::string name;
    for (const ifaddrs* i = list; i != nullptr && name.empty(); i = i->ifa_next) {
        if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
        sockaddr_in address{};
        std::memcpy(&address, i->ifa_addr, sizeof(address));
        if (text(address.sin_addr) == own_address) name = i->ifa_name;
    }
    freeifaddrs(list);
    const Descriptor handle(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ifreq request{};
    std::strncpy(request.ifr_name, name.c_str(), IFNAMSIZ - 1);
    if (name.empty() || handle.get() < 0 || ioctl(handle.get(), SIOCGIFMTU, &request) != 0)
        return kUsualMtu;
    return request.ifr_mtu;
}

std::uint64_t max_socket_buffer_bytes() {
    std::ifstream stream("/proc/sys/net/core/rmem_max");
    std::uint64_t bytes = 0;
    return stream >> bytes ? bytes : 0;
}

bool may_use_packet_sockets() {
    const Descriptor handle(socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0));
    return handle.get() >= 0;
}

}  // namespace atrium::capture
