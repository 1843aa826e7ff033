#include "site_node/hosts/host_clock.hpp"

#include <algorithm>

namespace atrium::hosts {

void HostClock::add(const Answer& answer, Time now) {
    // a clock was set on the way
    if (answer.returned < answer.asked || answer.answered < answer.received) return;
    const std::chrono::nanoseconds way =
        (answer.returned - answer.asked) - (answer.answered - answer.received);
    if (way.count() < 0) return;
    const auto there = answer.received - answer.asked;
    const auto back = answer.answered - answer.returned;
    samples_.push_back({there / 2 + back / 2, way / 2 + std::chrono::nanoseconds(1), now});
    if (samples_.size() > kWindow) samples_.pop_front();
}

// Each answer bounds the offset on its own, so all of them bound it together: the shortest way
// there and the shortest way back count, of whichever answers.
std::optional<HostClock::Estimate> HostClock::estimate(Time now) const {
    std::optional<Estimate> best;
    std::chrono::nanoseconds least{0};
    std::chrono::nanoseconds most{0};
    for (const Sample& sample : samples_) {
        const auto age = std::chrono::duration_cast<std::chrono::nanoseconds>(now - sample.time);
        if (age > kLongestAge) continue;
        const std::chrono::nanoseconds drift(
            static_cast<std::int64_t>(kMostDrift * static_cast<double>(age.count())));
        const Estimate alone{sample.offset, sample.error + drift};
        least = best ? std::max(least, alone.offset - alone.error) : alone.offset - alone.error;
        most = best ? std::min(most, alone.offset + alone.error) : alone.offset + alone.error;
        if (!best || alone.error < best->error) best = alone;
    }
    // they contradict each other if the clock was set by less than begins an epoch
    if (!best || least > most) return best;
    return Estimate{least + (most - least) / 2, (most - least) / 2 + std::chrono::nanoseconds(1)};
}

}  // namespace atrium::hosts
