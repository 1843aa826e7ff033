#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace atrium::test {

/// Impairments of a line for the packets that enter it. The defaults do nothing. Fractions are of
/// packets, 0..1.
struct Impairment {
    std::chrono::nanoseconds delay{0};  // one way
    /// The delay varies by at most this, up and down, slowly enough that no packet overtakes
    /// another. It moves between random values, one per four times `jitter`.
    std::chrono::nanoseconds jitter{0};
    double loss = 0.0;            // fraction lost, independently per packet
    double burst_start = 0.0;     // fraction at which a burst of losses starts
    double burst_length = 1.0;    // mean number of packets in a burst, >= 1
    double rate_bit_per_s = 0.0;  // of whole IP packets; 0: no limit
    /// A packet that would wait longer than this is dropped. Without a rate limit nothing waits.
    /// The default is that of a good home router.
    std::chrono::nanoseconds queue = std::chrono::milliseconds(100);
    double duplicated = 0.0;                   // fraction that arrives twice
    double held_back = 0.0;                    // fraction that arrives late: others overtake it,
    std::chrono::nanoseconds held_back_by{0};  // late by this much
};

/// Sums since the start; bytes are those of IP packets.
struct LineCounters {
    std::uint64_t entered = 0;  // packets
    std::uint64_t entered_bytes = 0;
    std::uint64_t duplicated = 0;  // extra packets that the line created
    std::uint64_t lost = 0;
    std::uint64_t dropped_by_queue = 0;
    std::uint64_t dropped_by_cut = 0;
    std::uint64_t left = 0;
    std::uint64_t left_bytes = 0;
    std::chrono::nanoseconds longest_queue{0};  // longest wait of a packet that was not dropped

    std::uint64_t in_flight() const {
        return entered + duplicated - lost - dropped_by_queue - dropped_by_cut - left;
    }
    bool operator==(const LineCounters&) const = default;
};

enum class Fate : std::uint8_t { kPasses, kLost, kQueueFull, kCut };

struct Passage {
    Fate fate = Fate::kPasses;
    std::int64_t leaves_ns = 0;  // when it passes
    bool twice = false;
};

/// One direction of a link: a bounded queue, then a rate limit, then loss, then delay, then
/// duplication. It keeps no packets and reads no clock. The fate of a packet follows from the seed,
/// its number, its size and the given times. Loss and duplication follow from the seed and the
/// number alone, and therefore hit the same packets under any load of the machine.
class ImpairedLine {
public:
    explicit ImpairedLine(std::uint64_t seed) : seed_(seed) {}

    /// Applies to packets that enter from now on. None of them overtakes an earlier one.
    void set(const Impairment& impairment);
    /// Nothing enters until `restore`. Packets on their way still arrive.
    void cut() { is_cut_ = true; }
    void restore() { is_cut_ = false; }

    /// `now_ns` must not decrease from call to call.
    Passage enter(std::int64_t now_ns, std::size_t num_bytes);
    /// Call for each packet once it is out, including duplicates.
    void note_left(std::size_t num_bytes);

    const LineCounters& counters() const { return counters_; }

private:
    bool is_lost(std::uint64_t number);
    std::int64_t jitter_at(std::int64_t time_ns) const;
    double random(unsigned purpose, std::uint64_t number) const;  // in [0, 1)

    std::uint64_t seed_;
    Impairment impairment_;
    bool is_cut_ = false;
    bool in_burst_ = false;
    bool started_ = false;
    std::int64_t first_ns_ = 0;
    std::int64_t free_ns_ = 0;         // when the rate limit has passed all earlier packets
    std::int64_t last_leaves_ns_ = 0;  // of packets that were not held back
    LineCounters counters_;
};

}  // namespace atrium::test
