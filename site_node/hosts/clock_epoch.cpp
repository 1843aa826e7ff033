#include "site_node/hosts/clock_epoch.hpp"

#include <algorithm>
#include <random>
#include <utility>

namespace atrium::hosts {
namespace {

using std::chrono::nanoseconds;

std::uint64_t random_number() {
    std::random_device device;
    return (static_cast<std::uint64_t>(device()) << 32U) | device();
}

}  // namespace

ClockEpoch::ClockEpoch(Clocks clocks)
    : clocks_(std::move(clocks)),
      followed_(difference_of_clocks(clocks_.settable, clocks_.steady)),
      last_look_(clocks_.steady()),
      number_(random_number()) {}

std::uint64_t ClockEpoch::current() {
    const std::lock_guard lock(mutex_);
    const nanoseconds difference = difference_of_clocks(clocks_.settable, clocks_.steady);
    const nanoseconds look = clocks_.steady();
    const nanoseconds allowed(static_cast<std::int64_t>(
        kMostRate * static_cast<double>((look - std::exchange(last_look_, look)).count())));
    const nanoseconds moved = difference - followed_;
    if (std::chrono::abs(moved) >= kLeastStep + allowed) {
        last_step_ = moved;
        followed_ = difference;
        number_ = random_number();
    } else {
        followed_ += std::clamp(moved, -allowed, allowed);
    }
    return number_;
}

std::chrono::nanoseconds ClockEpoch::last_step() const {
    const std::lock_guard lock(mutex_);
    return last_step_;
}

}  // namespace atrium::hosts
