#include "tools/tunnel/keeper.hpp"

#include "core/base/descriptor.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <mutex>
#include <optional>

namespace atrium::tunnel_tool {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kLookPeriod{1};
constexpr std::chrono::seconds kAskPeriod{30};  // for the address of the hub's name
constexpr int kEndTries = 50;                   // of 100 ms, for the other keeper to end

std::optional<sockaddr_in> address_of_hub(const keys::Tunnel& tunnel) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const std::string host = tunnel.hub.substr(0, tunnel.hub.find(':'));
    if (::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) return std::nullopt;
    sockaddr_in address{};
    std::memcpy(&address, found->ai_addr, sizeof address);
    ::freeaddrinfo(found);
    address.sin_port = htons(keys::port_of_hub(tunnel.hub));
    return address;
}

std::string text_of(const sockaddr_in& address) {
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &address.sin_addr, text.data(), text.size());
    return text.data();
}

// The address of this host from which packets to the hub leave; empty: there is no way.
std::string address_towards(const sockaddr_in& hub) {
    const Descriptor probe(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in own{};
    socklen_t size = sizeof own;
    // sends nothing
    if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&hub), sizeof hub) != 0 ||
        ::getsockname(probe.get(), reinterpret_cast<sockaddr*>(&own), &size) != 0)
        return {};
    return text_of(own);
}

}  // namespace

bool knows_hub(const keys::Tunnel& tunnel) { return address_of_hub(tunnel).has_value(); }

void keep(const keys::Tunnel& tunnel,
          const std::string& card,
          const Run& run,
          std::stop_token stop) {
    std::mutex mutex;
    std::condition_variable_any ended;
    std::optional<sockaddr_in> hub;
    Clock::time_point asked{};
    std::string told;  // both addresses
    for (;;) {
        {
            std::unique_lock lock(mutex);
            ended.wait_for(lock, stop, kLookPeriod, [] { return false; });
        }
        if (stop.stop_requested() || ::if_nametoindex(card.c_str()) == 0) return;
        if (tunnel.is_hub()) continue;
        if (const auto now = Clock::now(); !hub || now - asked >= kAskPeriod) {
            asked = now;
            if (const auto found = address_of_hub(tunnel)) hub = found;
        }
        if (!hub) continue;
        const std::string own = address_towards(*hub);
        if (own.empty()) continue;
        const std::string now = own + " " + text_of(*hub);
        if (now == told) continue;
        const std::string& key = tunnel.places.front().public_key;
        const std::string endpoint =
            fmt::format("{}:{}", text_of(*hub), keys::port_of_hub(tunnel.hub));
        if (run_or_fail(run, {"wg", "set", card, "peer", key, "endpoint", endpoint})) told = now;
    }
}

Expected<void> become_the_keeper(const std::string& card, const std::filesystem::path& folder) {
    const auto file = folder / fmt::format("atrium-{}.pid", card);
    const int lock = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    const auto failed = [&](const std::string& why) {
        return make_error(ErrorKind::kUnavailable, fmt::format("{}: {}", file.string(), why));
    };
    if (lock < 0) return failed(std::strerror(errno));
    for (int i = 0; ::flock(lock, LOCK_EX | LOCK_NB) != 0; ++i) {
        if (i >= kEndTries) return failed("the keeper before does not end");
        std::array<char, 16> text{};
        if (i == 0 && ::pread(lock, text.data(), text.size() - 1, 0) > 0) {
            const int id = std::atoi(text.data());
            if (id > 1) ::kill(id, SIGTERM);
        }
        ::usleep(100'000);
    }
    const std::string id = std::to_string(::getpid());
    if (::ftruncate(lock, 0) != 0 ||
        ::pwrite(lock, id.data(), id.size(), 0) != static_cast<ssize_t>(id.size()))
        return failed(std::strerror(errno));
    return {};  // the lock ends with the process
}

}  // namespace atrium::tunnel_tool
