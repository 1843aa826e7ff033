#include "tests/support/network/impaired_line.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::test {
namespace {

// Purposes of random numbers. Each has its own sequence, and one setting does not affect another.
enum Purpose : unsigned { kLoss, kBurstStart, kBurstEnd, kJitter, kTwice, kHeldBack };

// The finaliser of MurmurHash3, which spreads each bit over all others.
std::uint64_t mixed(std::uint64_t v) {
    v = (v ^ (v >> 33)) * 0xff51afd7ed558ccdULL;
    v = (v ^ (v >> 33)) * 0xc4ceb9fe1a85ec53ULL;
    return v ^ (v >> 33);
}

bool is_share(double v) { return v >= 0.0 && v <= 1.0; }

}  // namespace

void ImpairedLine::set(const Impairment& impairment) {
    assert(is_share(impairment.loss) && is_share(impairment.burst_start) &&
           is_share(impairment.duplicated) && is_share(impairment.held_back));
    assert(impairment.burst_length >= 1.0 && impairment.rate_bit_per_s >= 0.0);
    assert(impairment.jitter.count() >= 0 && impairment.delay >= impairment.jitter);
    impairment_ = impairment;
}

double ImpairedLine::random(unsigned purpose, std::uint64_t number) const {
    constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;
    const std::uint64_t bits = mixed(mixed(seed_ + kGolden * (purpose + 1)) + kGolden * number);
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

bool ImpairedLine::is_lost(std::uint64_t number) {
    if (in_burst_) {
        in_burst_ = random(kBurstEnd, number) >= 1.0 / impairment_.burst_length;
    } else {
        in_burst_ = random(kBurstStart, number) < impairment_.burst_start;
    }
    return in_burst_ || random(kLoss, number) < impairment_.loss;
}

std::int64_t ImpairedLine::jitter_at(std::int64_t time_ns) const {
    const std::int64_t most = impairment_.jitter.count();
    if (most == 0) return 0;
    const std::int64_t period = 4 * most;
    const std::int64_t since = time_ns - first_ns_;
    const auto knot = static_cast<std::uint64_t>(since / period);
    const double share = static_cast<double>(since % period) / static_cast<double>(period);
    const double before = 2.0 * random(kJitter, knot) - 1.0;
    const double after = 2.0 * random(kJitter, knot + 1) - 1.0;
    return std::llround(static_cast<double>(most) * std::lerp(before, after, share));
}

Passage ImpairedLine::enter(std::int64_t now_ns, std::size_t num_bytes) {
    if (!started_) {
        started_ = true;
        first_ns_ = now_ns;
    }
    const std::uint64_t number = counters_.entered++;
    counters_.entered_bytes += num_bytes;
    const bool lost = is_lost(number);  // always drawn: the sequence must not depend on the queue
    if (is_cut_) {
        ++counters_.dropped_by_cut;
        return {Fate::kCut, 0, false};
    }

    std::int64_t sent_ns = now_ns;
    if (impairment_.rate_bit_per_s > 0.0) {
        const std::int64_t starts_ns = std::max(now_ns, free_ns_);
        const std::chrono::nanoseconds wait(starts_ns - now_ns);
        if (wait > impairment_.queue) {
            ++counters_.dropped_by_queue;
            return {Fate::kQueueFull, 0, false};
        }
        counters_.longest_queue = std::max(counters_.longest_queue, wait);
        sent_ns = starts_ns +
                  std::llround(8e9 * static_cast<double>(num_bytes) / impairment_.rate_bit_per_s);
        free_ns_ = sent_ns;
    }
    if (lost) {  // lost on the way: it has used the rate
        ++counters_.lost;
        return {Fate::kLost, 0, false};
    }

    Passage passage;
    const std::int64_t due_ns = sent_ns + impairment_.delay.count() + jitter_at(sent_ns);
    if (random(kHeldBack, number) < impairment_.held_back) {
        passage.leaves_ns = due_ns + impairment_.held_back_by.count();
    } else {
        passage.leaves_ns = last_leaves_ns_ = std::max(due_ns, last_leaves_ns_);
    }
    passage.twice = random(kTwice, number) < impairment_.duplicated;
    if (passage.twice) ++counters_.duplicated;
    return passage;
}

void ImpairedLine::note_left(std::size_t num_bytes) {
    ++counters_.left;
    counters_.left_bytes += num_bytes;
}

}  // namespace atrium::test
