#include "site_node/hosts/host_clock.hpp"

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

std::optional<HostClock::Estimate> HostClock::estimate(Time now) const {
    std::optional<Estimate> best;
    for (const Sample& sample : samples_) {
        const auto age = std::chrono::duration_cast<std::chrono::nanoseconds>(now - sample.time);
        if (age > kLongestAge) continue;
        const std::chrono::nanoseconds drift(
            static_cast<std::int64_t>(kMostDrift * static_cast<double>(age.count())));
        if (!best || sample.error + drift < best->error)
            best = Estimate{sample.offset, sample.error + drift};
    }
    return best;
}

}  // namespace atrium::hosts
