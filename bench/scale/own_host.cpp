#include "bench/scale/own_host.hpp"

#include "core/app/private_network.hpp"
#include "core/base/descriptor.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <net/if.h>
#include <net/route.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>

namespace atrium::bench {
namespace {

tl::unexpected<Error> failed(const std::string& what) {
    return make_error(ErrorKind::kUnavailable, fmt::format("{}: {}", what, std::strerror(errno)));
}

void put(sockaddr& to, std::uint32_t address) {
    sockaddr_in from{};
    from.sin_family = AF_INET;
    from.sin_addr.s_addr = htonl(address);
    std::memcpy(&to, &from, sizeof(from));
}

Expected<void> allow_multicast() {
    const Descriptor socket_v4(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (socket_v4.get() < 0) return failed("a socket");
    std::string name = "lo";
    ifreq request{};
    name.copy(request.ifr_name, IFNAMSIZ - 1);
    if (ioctl(socket_v4.get(), SIOCGIFFLAGS, &request) != 0) return failed("lo");
    request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_MULTICAST);
    if (ioctl(socket_v4.get(), SIOCSIFFLAGS, &request) != 0) return failed("multicast on lo");
    rtentry route{};
    put(route.rt_dst, INADDR_UNSPEC_GROUP);
    put(route.rt_genmask, 0xf0000000U);
    route.rt_flags = RTF_UP;
    route.rt_dev = name.data();
    if (ioctl(socket_v4.get(), SIOCADDRT, &route) != 0) return failed("a route for multicast");
    return {};
}

std::chrono::nanoseconds ticks(std::int64_t count) {
    return std::chrono::nanoseconds(std::chrono::seconds(1)) * count / sysconf(_SC_CLK_TCK);
}

}  // namespace

Expected<void> enter_own_host() {
    if (auto entered = app::enter_private_network(); !entered) return entered;
    if (auto up = app::bring_up_loopback(1); !up) return up;
    return allow_multicast();
}

LoopbackCounters loopback_counters() {
    std::ifstream file("/proc/self/net/dev");
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find("lo:");
        if (colon == std::string::npos) continue;
        std::istringstream words(line.substr(colon + 3));
        LoopbackCounters counters;
        words >> counters.bytes >> counters.datagrams;  // received: on lo everything that was sent
        return counters;
    }
    return {};
}

std::chrono::nanoseconds processor_time(pid_t process) {
    clockid_t clock = 0;
    timespec time{};
    if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &time) != 0) return {};
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

std::chrono::nanoseconds host_processor_time() {
    std::ifstream file("/proc/stat");
    std::string name;
    std::array<std::int64_t, 8> spent{};  // user nice system idle iowait irq softirq steal
    file >> name;
    for (std::int64_t& value : spent) file >> value;
    return ticks(spent[0] + spent[1] + spent[2] + spent[5] + spent[6]);
}

std::int64_t memory_bytes(pid_t process) {
    std::ifstream file(fmt::format("/proc/{}/smaps_rollup", process));
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string name;
        std::int64_t kib = 0;
        if (words >> name >> kib && name == "Pss:") return 1024 * kib;
    }
    return 0;
}

}  // namespace atrium::bench
