#include "core/app/private_network.hpp"

#include "core/base/descriptor.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>

namespace atrium::app {
namespace {

constexpr const char* kLoopback = "lo";

tl::unexpected<Error> failed(const std::string& what, int error) {
    return make_error(ErrorKind::kUnavailable, fmt::format("{}: {}", what, std::strerror(error)));
}

// Value of a kernel setting; -1 if the kernel does not have it.
int setting(const char* name) {
    std::ifstream stream(std::string("/proc/sys/") + name);
    int value = -1;
    return stream >> value ? value : -1;
}

// Tells the user which setting permits namespaces.
std::string remedy(int error) {
    if (error == ENOSPC || setting("user/max_user_namespaces") == 0)
        return "raise the limit: sysctl user.max_user_namespaces=10000";
    if (setting("kernel/unprivileged_userns_clone") == 0)
        return "permit namespaces: sysctl kernel.unprivileged_userns_clone=1";
    if (setting("kernel/apparmor_restrict_unprivileged_userns") == 1)
        return "permit namespaces: sysctl kernel.apparmor_restrict_unprivileged_userns=0";
    return "permit unshare(2) in the policy of the container or sandbox";
}

tl::unexpected<Error> refused(const char* what, int error) {
    return failed(fmt::format("a network namespace cannot be made ({}); {}", what, remedy(error)),
                  error);
}

Expected<void> write_file(const char* path, const std::string& text) {
    const Descriptor file(open(path, O_WRONLY | O_CLOEXEC));
    if (file.get() < 0) return refused(path, errno);
    if (write(file.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size()))
        return refused(path, errno);
    return {};
}

// Sends one RTM_NEWADDR request and checks the reply.
Expected<void> add_address(int netlink, int interface_index, unsigned char last_byte) {
    struct {
        nlmsghdr header;
        ifaddrmsg message;
        rtattr attribute;
        std::array<unsigned char, 4> address;
    } request{};
    static_assert(sizeof(request) == NLMSG_LENGTH(sizeof(ifaddrmsg)) + RTA_LENGTH(4));
    request.header.nlmsg_len = sizeof(request);
    request.header.nlmsg_type = RTM_NEWADDR;
    request.header.nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK | NLM_F_CREATE | NLM_F_EXCL;
    request.message.ifa_family = AF_INET;
    request.message.ifa_prefixlen = 8;
    request.message.ifa_scope = RT_SCOPE_HOST;
    request.message.ifa_index = static_cast<unsigned>(interface_index);
    request.attribute.rta_type = IFA_LOCAL;
    request.attribute.rta_len = RTA_LENGTH(4);
    request.address = {127, 0, 0, last_byte};
    const std::string what = fmt::format("address 127.0.0.{} on {}", last_byte, kLoopback);
    if (send(netlink, &request, sizeof(request), 0) != static_cast<ssize_t>(sizeof(request)))
        return failed(what, errno);
    struct {
        nlmsghdr header;
        nlmsgerr error;
        std::array<char, 1024> rest;  // the kernel may append the request
    } answer{};
    const ssize_t num_bytes = recv(netlink, &answer, sizeof(answer), 0);
    if (num_bytes < static_cast<ssize_t>(NLMSG_LENGTH(sizeof(nlmsgerr))) ||
        answer.header.nlmsg_type != NLMSG_ERROR) {
        return failed(what, num_bytes < 0 ? errno : EPROTO);
    }
    if (answer.error.error != 0 && answer.error.error != -EEXIST)
        return failed(what, -answer.error.error);
    return {};
}

}  // namespace

Expected<void> enter_private_network() {
    const auto user = geteuid();  // before unshare: inside, no user is mapped yet
    const auto group = getegid();
    if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return refused("unshare", errno);
    // an unprivileged process has to deny setgroups before it may write gid_map
    const std::array<std::pair<const char*, std::string>, 3> files{
        {{"/proc/self/setgroups", "deny"},
         {"/proc/self/uid_map", fmt::format("0 {} 1", user)},
         {"/proc/self/gid_map", fmt::format("0 {} 1", group)}}};
    for (const auto& [path, text] : files) {
        if (auto written = write_file(path, text); !written) return written;
    }
    return {};
}

Expected<void> bring_up_loopback(int num_addresses) {
    assert(num_addresses >= 1 && num_addresses <= 254);
    const Descriptor socket_v4(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (socket_v4.get() < 0) return failed("a socket", errno);
    ifreq interface {};
    std::strncpy(interface.ifr_name, kLoopback, IFNAMSIZ - 1);
    if (ioctl(socket_v4.get(), SIOCGIFFLAGS, &interface) != 0) return failed(kLoopback, errno);
    interface.ifr_flags = static_cast<short>(interface.ifr_flags | IFF_UP);
    if (ioctl(socket_v4.get(), SIOCSIFFLAGS, &interface) != 0)
        return failed("bringing lo up", errno);

    const Descriptor netlink(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
    if (netlink.get() < 0) return failed("a netlink socket", errno);
    const int index = static_cast<int>(if_nametoindex(kLoopback));
    for (int i = 1; i <= num_addresses; ++i) {
        if (auto added = add_address(netlink.get(), index, static_cast<unsigned char>(i)); !added)
            return added;
    }
    return {};
}

}  // namespace atrium::app
