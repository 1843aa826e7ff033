#pragma once

#include "core/base/expected.hpp"

#include <sys/types.h>

#include <chrono>
#include <cstdint>

// A host of one's own, and what its programs cost.
namespace atrium::bench {

/// Moves this process, and those that it starts, into a network of its own with nothing but `lo`,
/// which also carries multicast there. First thing in main: before any thread is started.
Expected<void> enter_own_host();

/// What went through `lo` of this process's network so far.
struct LoopbackCounters {
    std::uint64_t datagrams = 0;
    std::uint64_t bytes = 0;  // with the headers of UDP and IP
};
LoopbackCounters loopback_counters();

/// Processor time of all threads of a process so far; 0 where it is gone.
std::chrono::nanoseconds processor_time(pid_t process);
/// Of all programs and the kernel, on all cores together, so far.
std::chrono::nanoseconds host_processor_time();

/// Memory of a process [bytes], with its share of what it has in common with others (PSS); 0 where
/// it is gone.
std::int64_t memory_bytes(pid_t process);

}  // namespace atrium::bench
