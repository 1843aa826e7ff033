#include "site_node/hosts/clock_epoch.hpp"

#include <random>

namespace atrium::hosts {
namespace {

std::uint64_t random_number() {
    std::random_device device;
    return (static_cast<std::uint64_t>(device()) << 32U) | device();
}

}  // namespace

ClockEpoch::ClockEpoch(Clocks clocks)
    : clocks_(std::move(clocks)), last_difference_(difference()), number_(random_number()) {}

// The shortest of three looks: a thread may lose its core between the two clocks.
std::chrono::nanoseconds ClockEpoch::difference() const {
    std::chrono::nanoseconds best_gap = std::chrono::nanoseconds::max();
    std::chrono::nanoseconds best{};
    for (int look = 0; look < 3; ++look) {
        const auto before = clocks_.steady();
        const Timestamp now = clocks_.settable();
        const auto after = clocks_.steady();
        if (after - before >= best_gap) continue;
        best_gap = after - before;
        best = std::chrono::nanoseconds(now.ns) - (before + best_gap / 2);
    }
    return best;
}

std::uint64_t ClockEpoch::current() {
    const std::lock_guard lock(mutex_);
    const std::chrono::nanoseconds now = difference();
    const std::chrono::nanoseconds step = now - last_difference_;
    last_difference_ = now;
    if (std::chrono::abs(step) >= kLeastStep) {
        last_step_ = step;
        number_ = random_number();
    }
    return number_;
}

std::chrono::nanoseconds ClockEpoch::last_step() const {
    const std::lock_guard lock(mutex_);
    return last_step_;
}

}  // namespace atrium::hosts
