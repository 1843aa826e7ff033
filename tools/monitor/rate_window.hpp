#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>

namespace atrium::monitor {

/// Measures a rate over the last two seconds. Uses constant memory.
class RateWindow {
public:
    using Clock = std::chrono::steady_clock;

    void add(double amount, Clock::time_point now) {
        const std::int64_t slot = slot_of(now);
        if (first_slot_ < 0) first_slot_ = slot;
        Bucket& bucket = buckets_[static_cast<std::size_t>(slot) % buckets_.size()];
        if (bucket.slot != slot) bucket = {slot, 0.0};
        bucket.amount += amount;
    }

    /// Rate per second, over two seconds or since the first `add` if that is shorter.
    double per_s(Clock::time_point now) const {
        if (first_slot_ < 0) return 0.0;
        const std::int64_t last = slot_of(now);
        double sum = 0.0;
        for (const Bucket& bucket : buckets_) {
            if (bucket.slot > last - kNumSlots && bucket.slot <= last) sum += bucket.amount;
        }
        const std::int64_t age = std::clamp<std::int64_t>(last - first_slot_ + 1, 1, kNumSlots);
        return sum / (static_cast<double>(age) * kSlot_s);
    }

private:
    static constexpr std::int64_t kNumSlots = 10;
    static constexpr double kSlot_s = 0.2;  // period of the viewers' feedback
    static std::int64_t slot_of(Clock::time_point time) {
        return std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch())
                   .count() /
               200;
    }
    struct Bucket {
        std::int64_t slot = -1;
        double amount = 0.0;
    };
    std::array<Bucket, kNumSlots> buckets_{};
    std::int64_t first_slot_ = -1;
};

}  // namespace atrium::monitor
