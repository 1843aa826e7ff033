#include "core/base/descriptor.hpp"
#include "tools/doctor/facts/system.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <grp.h>
#include <ifaddrs.h>
#include <linux/capability.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>

namespace atrium::doctor {
namespace {

constexpr std::uint16_t kDdsPort = 7400;  // of domain 0, whose firewall rules matter
constexpr const char* kDdsGroup = "239.255.0.1";
constexpr std::chrono::milliseconds kHearTime{300};

std::uint64_t own_capabilities(const System& system) {
    for (const std::string& line : lines_of(system.read("/proc/self/status").value_or(""))) {
        if (line.rfind("CapEff:", 0) == 0)
            return std::strtoull(line.c_str() + std::strlen("CapEff:"), nullptr, 16);
    }
    return 0;
}

bool has(std::uint64_t capabilities, unsigned which) { return (capabilities >> which & 1U) != 0; }

template <typename Value>
bool set_option(int socket, int level, int name, const Value& value) {
    return setsockopt(socket, level, name, &value, sizeof value) == 0;
}

}  // namespace

bool LiveSystem::has_card(const std::string& name) const {
    return if_nametoindex(name.c_str()) != 0;
}

std::optional<std::vector<CardAddress>> LiveSystem::card_addresses() const {
    std::vector<CardAddress> addresses;
    ifaddrs* list = nullptr;
    if (getifaddrs(&list) != 0) return std::nullopt;
    for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
        if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
        sockaddr_in address{};
        std::memcpy(&address, entry->ifa_addr, sizeof address);
        CardAddress found{entry->ifa_name, ntohl(address.sin_addr.s_addr), 32};
        if (entry->ifa_netmask != nullptr) {
            sockaddr_in mask{};
            std::memcpy(&mask, entry->ifa_netmask, sizeof mask);
            found.prefix = std::popcount(mask.sin_addr.s_addr);
        }
        addresses.push_back(std::move(found));
    }
    freeifaddrs(list);
    return addresses;
}

std::optional<System::Clock> LiveSystem::clock() const {
    timex now{};
    const int state = adjtimex(&now);
    if (state < 0) return std::nullopt;
    return Clock{state != TIME_ERROR && (now.status & STA_UNSYNC) == 0,
                 1e-3 * static_cast<double>(now.maxerror)};
}

User LiveSystem::user() const {
    User user;
    user.id = geteuid();
    user.is_root = user.id == 0;
    const passwd* entry = getpwuid(user.id);
    user.name = entry == nullptr ? std::to_string(user.id) : entry->pw_name;
    std::array<gid_t, 1024> groups{};
    const int num = getgroups(static_cast<int>(groups.size()), groups.data());
    for (int i = 0; i < num; ++i) user.groups.push_back(groups[static_cast<std::size_t>(i)]);
    user.groups.push_back(getegid());
    const std::uint64_t capabilities = own_capabilities(*this);
    user.has_net_raw = has(capabilities, CAP_NET_RAW);
    user.has_sys_nice = has(capabilities, CAP_SYS_NICE);
    return user;
}

bool LiveSystem::may_open(const std::string& file) const {
    return faccessat(AT_FDCWD, at(file).c_str(), R_OK | W_OK, AT_EACCESS) == 0 || errno == ENOENT;
}

std::optional<std::uint64_t> LiveSystem::file_capabilities(
    const std::filesystem::path& file) const {
    vfs_ns_cap_data data{};
    const ssize_t size = getxattr(file.c_str(), "security.capability", &data, sizeof data);
    if (size < 0) return errno == ENODATA ? std::optional<std::uint64_t>(0) : std::nullopt;
    if (size < static_cast<ssize_t>(XATTR_CAPS_SZ_2)) return 0;
    return data.data[0].permitted | std::uint64_t{data.data[1].permitted} << 32U;
}

std::optional<bool> LiveSystem::hears_multicast(std::uint32_t card_address) const {
    const Descriptor ear(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const Descriptor mouth(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in group{};
    group.sin_family = AF_INET;
    group.sin_port = htons(kDdsPort);
    inet_pton(AF_INET, kDdsGroup, &group.sin_addr);
    ip_mreqn card{};
    card.imr_multiaddr = group.sin_addr;
    card.imr_address.s_addr = htonl(card_address);
    // programs of Atrium share the port in the same way
    if (ear.get() < 0 || mouth.get() < 0 || !set_option(ear.get(), SOL_SOCKET, SO_REUSEADDR, 1) ||
        bind(ear.get(), reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0) {
        return std::nullopt;
    }
    if (!set_option(ear.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, card) ||
        !set_option(mouth.get(), IPPROTO_IP, IP_MULTICAST_IF, card) ||
        !set_option(mouth.get(), IPPROTO_IP, IP_MULTICAST_LOOP, 1) ||
        !set_option(mouth.get(), IPPROTO_IP, IP_MULTICAST_TTL, 0)) {
        return false;
    }
    const std::string said = "atrium doctor " + std::to_string(getpid());
    if (sendto(mouth.get(),
               said.data(),
               said.size(),
               0,
               reinterpret_cast<const sockaddr*>(&group),
               sizeof group) < 0) {
        return false;
    }
    const auto end = std::chrono::steady_clock::now() + kHearTime;
    for (auto left = kHearTime; left.count() > 0;
         left = std::chrono::duration_cast<std::chrono::milliseconds>(
             end - std::chrono::steady_clock::now())) {
        pollfd waiting{ear.get(), POLLIN, 0};
        if (poll(&waiting, 1, static_cast<int>(left.count())) <= 0) continue;
        std::array<char, 2048> heard{};
        const ssize_t num_bytes = recv(ear.get(), heard.data(), heard.size(), 0);
        if (num_bytes > 0 && said == std::string(heard.data(), static_cast<std::size_t>(num_bytes)))
            return true;
    }
    return false;
}

Expected<double> LiveSystem::write_speed(const std::filesystem::path& folder,
                                         std::uint64_t bytes) const {
    const auto failed = [&](int error) {
        return make_error(ErrorKind::kUnavailable, std::strerror(error));
    };
    constexpr std::size_t kPart = 1U << 20U;
    const std::unique_ptr<void, void (*)(void*)> part(std::aligned_alloc(4096, kPart), &std::free);
    if (part == nullptr) return failed(ENOMEM);
    std::memset(part.get(), 0x5a, kPart);
    std::string name = folder / ".atrium_doctor_XXXXXX";
    const Descriptor file(mkostemp(name.data(), O_CLOEXEC));
    if (file.get() < 0) return failed(errno);
    unlink(name.c_str());
    // past the page cache where the file system can
    const int flags = fcntl(file.get(), F_GETFL);
    fcntl(file.get(), F_SETFL, flags | O_DIRECT);
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint64_t done = 0; done < bytes;) {
        const ssize_t num_bytes = write(file.get(), part.get(), kPart);
        if (num_bytes < 0 && errno == EINVAL) {
            fcntl(file.get(), F_SETFL, flags);
            continue;
        }
        if (num_bytes <= 0) return failed(num_bytes < 0 ? errno : EIO);
        done += static_cast<std::uint64_t>(num_bytes);
    }
    if (fsync(file.get()) != 0) return failed(errno);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    return 1e-6 * static_cast<double>(bytes) / std::max(1e-6, took.count());
}

std::optional<std::uint64_t> LiveSystem::free_bytes(const std::filesystem::path& folder) const {
    struct statvfs space {};
    if (statvfs(folder.c_str(), &space) != 0) return std::nullopt;
    return std::uint64_t{space.f_bavail} * space.f_frsize;
}

bool LiveSystem::let_time_pass() const {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    return true;
}

std::optional<System::Output> LiveSystem::run(const std::vector<std::string>& command) const {
    return run_command(command);
}

std::string LiveSystem::variable(const std::string& name) const {
    const char* value = std::getenv(name.c_str());
    return value == nullptr ? "" : value;
}

}  // namespace atrium::doctor
