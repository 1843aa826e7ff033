#pragma once

#include "monitor/report.hpp"

#include <optional>
#include <string>

namespace atrium::monitor {

/// The clock of the host on which a program runs, as the program says.
struct HostClock {
    std::string host;
    bool is_synchronised = false;
    double max_error_ms = 0.0;
};

struct Comparison {
    ClockTrust trust = ClockTrust::kOneClock;
    double error_ms = 0.0;
};

/// What a time of one clock minus a time of the other is worth. Nothing: the host is not known.
Comparison compare(const std::optional<HostClock>& a, const std::optional<HostClock>& b);

/// Of a figure that mixes both: the lesser trust, the larger error.
Comparison worse(const Comparison& a, const Comparison& b);

/// "clocks of A and B are not synchronised (B is not), latencies between them mean nothing".
std::string unsynchronised_notice(const HostClock& a, const HostClock& b);

}  // namespace atrium::monitor
