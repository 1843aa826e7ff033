#include "tools/monitor/clock_trust.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::monitor {

Comparison compare(const std::optional<HostClock>& a, const std::optional<HostClock>& b) {
    if (!a || !b) return {ClockTrust::kUnknown, 0.0};
    if (a->host == b->host) return {ClockTrust::kOneClock, 0.0};
    if (!a->is_synchronised || !b->is_synchronised) return {ClockTrust::kUnsynchronised, 0.0};
    return {ClockTrust::kSynchronised, a->max_error_ms + b->max_error_ms};
}

Comparison worse(const Comparison& a, const Comparison& b) {
    return {std::max(a.trust, b.trust), std::max(a.error_ms, b.error_ms)};
}

std::string unsynchronised_notice(const HostClock& a, const HostClock& b) {
    const HostClock& first = a.host < b.host ? a : b;
    const HostClock& second = a.host < b.host ? b : a;
    const std::string which = !first.is_synchronised && !second.is_synchronised ? "neither is"
                              : !first.is_synchronised ? first.host + " is not"
                                                       : second.host + " is not";
    return fmt::format(
        "clocks of {} and {} are not synchronised ({}), latencies between them mean nothing",
        first.host,
        second.host,
        which);
}

}  // namespace atrium::monitor
