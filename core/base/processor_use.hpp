#pragma once

#include "core/base/descriptor.hpp"

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

/// Measures how long a program ran on the host's cores, and how long it was ready to run and waited
/// for a core.
///
/// The kernel counts a wait when it ends, so a thread that waits right now is not counted yet. Time
/// that a hypervisor takes from the host counts as run, not as waited.
namespace atrium {

/// One line of /proc/PID/task/TID/schedstat.
struct SchedStat {
    std::uint64_t run_ns = 0;     // on a core
    std::uint64_t waited_ns = 0;  // ready to run, without a core
    std::uint64_t num_runs = 0;   // times that it got one
};

/// Nothing where `text` is not three decimal numbers, or says that the kernel does not count.
std::optional<SchedStat> parse_schedstat(std::string_view text);

/// What all threads of a program got of the host's cores.
struct ProcessorUse {
    std::uint64_t run_ns = 0;         // since the program's start
    std::uint64_t waited_ns = 0;      // likewise; waits of several threads at once add up
    double run_per_s = 0.0;           // cores used in the last interval
    double waited_per_s = 0.0;        // seconds waited per second of it, added up over the threads
    double longest_wait_per_s = 0.0;  // of the thread that waited longest, at most 1
    bool is_waiting_known = false;    // false: the kernel does not say; the waits mean nothing
    std::int16_t nice = 0;            // -20 goes first, 19 last

    bool operator==(const ProcessorUse&) const = default;
};

/// Reads /proc of this process: one small file per thread, meant for once a second. Its totals
/// never go back: threads that ended stay counted. What a thread waited between the last reading
/// and its end is lost; what it ran is not. Not thread-safe.
class ProcessorMeter {
public:
    using Clock = std::chrono::steady_clock;

    /// `tasks` has one folder per thread, with a file `schedstat`.
    explicit ProcessorMeter(std::string tasks = "/proc/self/task",
                            Clock::time_point now = Clock::now());

    /// Totals of now, and rates since the last reading (the first time since construction). Sooner
    /// than kLeastInterval after it nothing is read, and the last result holds: a thread's wait is
    /// counted when it ends, so in a few milliseconds seconds of it may be found.
    ProcessorUse update(Clock::time_point now = Clock::now());
    static constexpr std::chrono::milliseconds kLeastInterval{200};

private:
    struct Waits {
        std::uint64_t sum_ns = 0;      // of all threads, since the last reading
        std::uint64_t longest_ns = 0;  // of one
        bool is_known = false;
    };
    Waits read_threads();

    std::string tasks_;
    std::map<pid_t, SchedStat> threads_;  // as read last, of those that were there then
    ProcessorUse use_;
    Clock::time_point last_;
};

}  // namespace atrium
