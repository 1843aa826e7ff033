#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace atrium::viewer {

/// Keeps a value over the last 30 seconds for a curve: the mean of each quarter of a second, 0 for
/// slots without values. Uses constant memory.
class History {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::size_t kLength = 120;
    static constexpr std::chrono::milliseconds kSlot{250};

    void add(double value, Clock::time_point now) {
        Slot& slot = slots_[index_of(now) % kLength];
        if (slot.index != index_of(now)) slot = {index_of(now), 0.0, 0};
        slot.sum += value;
        ++slot.num;
    }
    /// kPerSecond sums each slot and divides by its length, for counts.
    enum class Of { kMean, kPerSecond };
    /// Values, oldest first, without the slot that is still open.
    std::array<float, kLength - 1> values(Of of, Clock::time_point now) const {
        std::array<float, kLength - 1> values{};
        const std::size_t last = index_of(now);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const std::size_t index = last - values.size() + i;
            const Slot& slot = slots_[index % kLength];
            if (slot.index != index || slot.num == 0) continue;
            const double per = of == Of::kMean ? static_cast<double>(slot.num)
                                               : std::chrono::duration<double>(kSlot).count();
            values[i] = static_cast<float>(slot.sum / per);
        }
        return values;
    }

private:
    struct Slot {
        std::size_t index = 0;
        double sum = 0.0;
        std::size_t num = 0;
    };
    static std::size_t index_of(Clock::time_point time) {
        return static_cast<std::size_t>(time.time_since_epoch() / kSlot);
    }
    std::array<Slot, kLength> slots_{};
};

}  // namespace atrium::viewer
