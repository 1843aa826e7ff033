#include "tests/support/network/network_host.hpp"

#include "core/app/private_network.hpp"
#include "tests/support/network/descriptor_passing.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/if_tun.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace atrium::test {
namespace {

constexpr int kMtu = 1500;
// Number of packets that may wait for the relay. The kernel drops more. Its default of 500 is less
// than a burst of large samples.
constexpr std::uint32_t kDeviceQueue = 20'000;

tl::unexpected<Error> failed(const std::string& what) {
    return make_error(ErrorKind::kUnavailable, fmt::format("{}: {}", what, std::strerror(errno)));
}

sockaddr_in socket_address(std::uint32_t address, std::uint16_t port = 0) {
    sockaddr_in result{};
    result.sin_family = AF_INET;
    result.sin_addr.s_addr = htonl(address);
    result.sin_port = htons(port);
    return result;
}

void put(sockaddr& to, std::uint32_t address) {
    const sockaddr_in from = socket_address(address);
    std::memcpy(&to, &from, sizeof(from));
}

// A socket belongs to the network namespace in which it is opened.
Expected<std::unique_ptr<Descriptor>> open_tun() {
    auto tun = std::make_unique<Descriptor>(open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC));
    if (tun->get() < 0) return failed("/dev/net/tun");
    ifreq request{};
    std::strncpy(request.ifr_name, kLinkName, IFNAMSIZ - 1);
    request.ifr_flags = IFF_TUN | IFF_NO_PI;
    if (ioctl(tun->get(), TUNSETIFF, &request) != 0) return failed("a TUN device");
    return tun;
}

// Uses netlink, because the older interface needs root outside.
Expected<void> lengthen_queue() {
    const Descriptor netlink(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
    struct {
        nlmsghdr header;
        ifinfomsg message;
        rtattr attribute;
        std::uint32_t length;
    } request{};
    static_assert(sizeof(request) == NLMSG_LENGTH(sizeof(ifinfomsg)) + RTA_LENGTH(4));
    request.header.nlmsg_len = sizeof(request);
    request.header.nlmsg_type = RTM_NEWLINK;
    request.header.nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
    request.message.ifi_index = static_cast<int>(if_nametoindex(kLinkName));
    request.attribute.rta_type = IFLA_TXQLEN;
    request.attribute.rta_len = RTA_LENGTH(4);
    request.length = kDeviceQueue;
    struct {
        nlmsghdr header;
        nlmsgerr error;
        std::array<char, 1024> rest;  // the kernel may send the request back
    } answer{};
    if (send(netlink.get(), &request, sizeof(request), 0) < 0 ||
        recv(netlink.get(), &answer, sizeof(answer), 0) < 0)
        return failed("the link's queue");
    errno = -answer.error.error;
    if (errno != 0) return failed("the link's queue");
    return {};
}

Expected<void> set_up_link(std::uint32_t address) {
    const Descriptor socket_v4(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    ifreq request{};
    std::strncpy(request.ifr_name, kLinkName, IFNAMSIZ - 1);
    const auto asked = [&](unsigned long what) {
        return ioctl(socket_v4.get(), what, &request) == 0;
    };
    put(request.ifr_addr, address);
    if (!asked(SIOCSIFADDR)) return failed("the link's address");
    put(request.ifr_netmask, 0xffffff00U);
    if (!asked(SIOCSIFNETMASK)) return failed("the link's mask");
    request.ifr_mtu = kMtu;
    if (!asked(SIOCSIFMTU)) return failed("the link's MTU");
    request.ifr_flags = IFF_UP | IFF_RUNNING | IFF_MULTICAST | IFF_NOARP;
    if (!asked(SIOCSIFFLAGS)) return failed("bringing the link up");

    rtentry route{};
    std::string name = kLinkName;
    put(route.rt_dst, INADDR_UNSPEC_GROUP);
    put(route.rt_genmask, 0xf0000000U);
    route.rt_flags = RTF_UP;
    route.rt_dev = name.data();
    if (ioctl(socket_v4.get(), SIOCADDRT, &route) != 0) return failed("a route for multicast");
    return lengthen_queue();
}

// Turns the calling process, which must have one thread, into the host.
Expected<PassedDescriptors> become_host(std::uint32_t address) {
    if (auto entered = app::enter_private_network(); !entered)
        return tl::unexpected(entered.error());
    if (auto up = app::bring_up_loopback(1); !up) return tl::unexpected(up.error());
    auto tun = open_tun();
    if (!tun) return tl::unexpected(tun.error());
    if (auto up = set_up_link(address); !up) return tl::unexpected(up.error());
    PassedDescriptors made;
    made.push_back(std::move(*tun));
    for (const char* path : {"/proc/self/ns/user", "/proc/self/ns/net"}) {
        made.push_back(std::make_unique<Descriptor>(open(path, O_RDONLY | O_CLOEXEC)));
        if (made.back()->get() < 0) return failed(path);
    }
    return made;
}

}  // namespace

Expected<NetworkHost> make_network_host(std::uint32_t address) {
    auto made = descriptors_made_in_child([&] { return become_host(address); });
    if (!made) return tl::unexpected(made.error());
    if (made->size() != 3) return make_error(ErrorKind::kInternal, "descriptors are missing");
    return NetworkHost{
        std::move((*made)[0]), std::move((*made)[1]), std::move((*made)[2]), address};
}

bool enter(const NetworkHost& host) {
    return setns(host.user_namespace->get(), CLONE_NEWUSER) == 0 &&
           setns(host.network_namespace->get(), CLONE_NEWNET) == 0;
}

Expected<std::unique_ptr<Descriptor>> open_udp_socket(const NetworkHost& host, std::uint16_t port) {
    const auto make = [&]() -> Expected<PassedDescriptors> {
        PassedDescriptors made;
        if (!enter(host)) return failed("entering a network namespace");
        made.push_back(std::make_unique<Descriptor>(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)));
        const sockaddr_in name = socket_address(host.address, port);
        if (bind(made[0]->get(), reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0)
            return failed(fmt::format("UDP port {}", port));
        const int on = 1;
        if (setsockopt(made[0]->get(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on)) != 0)
            return failed("time stamps of packets");
        return made;
    };
    auto made = descriptors_made_in_child(make);
    if (!made) return tl::unexpected(made.error());
    return std::move(made->at(0));
}

}  // namespace atrium::test
