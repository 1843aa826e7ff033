#pragma once

#include "core/base/expected.hpp"

#include <sys/types.h>

#include <chrono>
#include <cstdint>

// A private host, and the cost of its programs.
namespace atrium::bench {

/// Moves this process and its children into a private network with only `lo`, which carries
/// multicast there. Call this first in main, before any thread starts.
Expected<void> enter_own_host();

/// Traffic through `lo` of this process's network so far.
struct LoopbackCounters {
    std::uint64_t datagrams = 0;
    std::uint64_t bytes = 0;  // with the headers of UDP and IP
};
LoopbackCounters loopback_counters();

/// Processor time of all threads of a process so far; 0 if it has ended.
std::chrono::nanoseconds processor_time(pid_t process);
/// Processor time of all programs and the kernel, on all cores together, so far.
std::chrono::nanoseconds host_processor_time();

/// Memory of a process [bytes], with its share of memory common with others (PSS); 0 if it has
/// ended.
std::int64_t memory_bytes(pid_t process);

}  // namespace atrium::bench
