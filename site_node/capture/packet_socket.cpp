#include "site_node/capture/packet_socket.hpp"

#include <linux/filter.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>

namespace atrium::capture {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollPeriod{2};
// The kernel hands a block of packets to Aravis after at most 5 ms; its timer has steps of up to 10
// ms.
constexpr std::chrono::milliseconds kBlockTime{30};

// Returns true if the filter compares the UDP destination port with `port`.
bool lets_pass_only(int packet_socket, std::uint16_t port) {
    std::array<sock_filter, 64> filter{};
    socklen_t length = filter.size();  // in instructions
    if (getsockopt(packet_socket, SOL_SOCKET, SO_GET_FILTER, filter.data(), &length) != 0)
        return false;
    constexpr std::uint32_t kDestinationPort = 16;  // after the Ethernet and IP headers
    for (std::size_t i = 0; i + 1 < length; ++i) {
        if (filter[i].code == (BPF_LD | BPF_H | BPF_IND) && filter[i].k == kDestinationPort &&
            filter[i + 1].code == (BPF_JMP | BPF_JEQ | BPF_K) && filter[i + 1].k == port) {
            return true;
        }
    }
    return false;
}

bool is_packet_socket(int descriptor) {
    int domain = 0;
    socklen_t size = sizeof(domain);
    return getsockopt(descriptor, SOL_SOCKET, SO_DOMAIN, &domain, &size) == 0 &&
           domain == AF_PACKET;
}

std::optional<int> find_filtered(std::uint16_t port) {
    std::error_code failed;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", failed)) {
        const std::string name = entry.path().filename().string();
        int descriptor = -1;
        std::from_chars(name.data(), name.data() + name.size(), descriptor);
        if (descriptor >= 0 && is_packet_socket(descriptor) && lets_pass_only(descriptor, port))
            return descriptor;
    }
    return std::nullopt;
}

// Returns true if the receiving thread has not yet given back a block.
bool holds_packets(int packet_socket) {
    pollfd state{packet_socket, POLLIN, 0};
    return poll(&state, 1, 0) > 0;
}

}  // namespace

Expected<void> wait_for_empty_packet_socket(std::uint16_t port, std::chrono::nanoseconds timeout) {
    const auto end = Clock::now() + timeout;
    std::optional<int> descriptor = find_filtered(port);
    while (!descriptor && Clock::now() < end) {
        std::this_thread::sleep_for(kPollPeriod);
        descriptor = find_filtered(port);
    }
    if (!descriptor) return {};
    std::this_thread::sleep_for(kBlockTime);
    while (holds_packets(*descriptor)) {
        if (Clock::now() > end + kBlockTime) {
            return make_error(ErrorKind::kUnavailable,
                              "packets of other cameras stay in the socket of the stream");
        }
        std::this_thread::sleep_for(kPollPeriod);
    }
    return {};
}

}  // namespace atrium::capture
