#pragma once

#include "tools/monitor/report.hpp"

#include <optional>
#include <string>

namespace atrium::monitor {

/// Clock of a program's host, as the program reports it.
struct HostClock {
    std::string host;
    bool is_synchronised = false;
    double max_error_ms = 0.0;
};

struct Comparison {
    ClockTrust trust = ClockTrust::kOneClock;
    double error_ms = 0.0;
};

/// How far a difference of times of two clocks can be trusted. Empty: the host is unknown.
Comparison compare(const std::optional<HostClock>& a, const std::optional<HostClock>& b);

/// For a value that mixes both: the lower trust and the larger error.
Comparison worse(const Comparison& a, const Comparison& b);

/// "clocks of A and B are not synchronised (B is not), latencies between them mean nothing".
std::string unsynchronised_notice(const HostClock& a, const HostClock& b);

}  // namespace atrium::monitor
