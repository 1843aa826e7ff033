#include "core/presence/clock_watch.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::presence {
namespace {

constexpr std::size_t kMaxHosts = 256;  // limit on data from untrusted senders

constexpr int kNumSamples = 3;  // of which at most one waited for this program

}  // namespace

std::optional<std::string> ClockWatch::see(const std::string& host,
                                           std::uint64_t instance,
                                           Timestamp written,
                                           Timestamp now) {
    if (hosts_.size() >= kMaxHosts && !hosts_.contains(host)) return std::nullopt;
    Host& known = hosts_[host];
    if (known.is_reported) return std::nullopt;
    const std::chrono::nanoseconds delay(now.ns - written.ns);
    if (known.instance != instance) known = {.instance = instance, .shortest_delay = delay};
    known.shortest_delay = std::min(known.shortest_delay, delay);
    ++known.num_samples;
    const bool is_ahead = delay < -kAhead;
    const bool is_behind = known.num_samples >= kNumSamples && known.shortest_delay > kBehind;
    if (!is_ahead && !is_behind) return std::nullopt;
    known.is_reported = true;
    const std::chrono::duration<double> offset = is_ahead ? -delay : known.shortest_delay;
    return fmt::format(
        "clock_differs host={} the clock of {} is about {:.1f} s {} this host's: latencies between "
        "them mean nothing; synchronise both with NTP or PTP, for example timedatectl set-ntp true "
        "(atrium doctor on each)",
        host,
        host,
        offset.count(),
        is_ahead ? "ahead of" : "behind");
}

}  // namespace atrium::presence
