#pragma once

#include <chrono>

namespace atrium::presence {

/// What this host's kernel says of its clock (adjtimex).
struct KernelClock {
    bool is_synchronised = false;  // NTP or PTP keeps it
    std::chrono::nanoseconds max_error{0};
};

KernelClock kernel_clock();

}  // namespace atrium::presence
