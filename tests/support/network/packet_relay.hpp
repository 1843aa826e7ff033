#pragma once

#include "core/base/descriptor.hpp"
#include "tests/support/network/impaired_line.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace atrium::test {

/// From a host's view: `kUp` leaves it, `kDown` arrives.
enum class Way : std::uint8_t { kUp, kDown };

/// Moves IPv4 packets between TUN devices, like a hub with one line per host: up the sender's line,
/// and down the line of the destination or, for multicast, of all others. It drops other packets,
/// and IGMP, which the kernel sends on its own, without counting them. A private thread sleeps
/// until a packet arrives or is due.
///
/// A packet enters its second line at the instant at which it was due, not when the thread handled
/// it. The delay of its delivery is measured.
class PacketRelay {
public:
    struct Port {
        std::unique_ptr<Descriptor> tun;
        std::uint32_t address = 0;  // IPv4, host byte order
    };

    /// `seed` decides everything random.
    PacketRelay(std::vector<Port> ports, std::uint64_t seed);
    ~PacketRelay();
    PacketRelay(const PacketRelay&) = delete;
    PacketRelay& operator=(const PacketRelay&) = delete;

    void set(int port, Way way, const Impairment& impairment);
    void cut(int port, Way way);
    void restore(int port, Way way);
    LineCounters counters(int port, Way way) const;

    /// Lateness of one packet, since the start or the last `forget_lateness`.
    std::chrono::nanoseconds largest_lateness() const;
    void forget_lateness();
    /// Processor time of the thread so far.
    std::chrono::nanoseconds processor_time() const;

private:
    struct Packet {
        std::array<std::uint8_t, 2048> bytes;  // more than the MTU
        std::size_t num_bytes = 0;
        int num_uses = 0;
    };
    struct Event {  // a packet reaches the end of a line
        std::int64_t due_ns = 0;
        std::uint64_t order = 0;  // packets due at the same time keep their order
        int line = 0;
        int packet = 0;
    };
    static bool is_later(const Event& a, const Event& b);

    int line_of(int port, Way way) const { return 2 * port + (way == Way::kDown ? 1 : 0); }
    void run(const std::stop_token& stop);
    void read_all(int port);
    void enter(int line, int packet, std::int64_t now_ns);
    void leave(const Event& event);
    void forward(int from_port, int packet, std::int64_t now_ns);
    void write(int port, const Event& event);
    int new_packet();
    void release(int packet);
    void deliver_due();
    void arm_timer();

    std::vector<Port> ports_;
    Descriptor epoll_;
    Descriptor timer_;
    Descriptor stop_event_;
    mutable std::mutex mutex_;         // guards the members below
    std::vector<ImpairedLine> lines_;  // up and down of each port
    std::vector<Event> events_;        // a heap with the next event first
    std::vector<std::unique_ptr<Packet>> packets_;
    std::vector<int> free_packets_;
    std::uint64_t num_events_ = 0;
    std::int64_t largest_lateness_ns_ = 0;
    std::jthread thread_;  // last: uses all of the above
};

}  // namespace atrium::test
