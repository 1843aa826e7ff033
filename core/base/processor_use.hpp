#pragma once

#include "core/base/descriptor.hpp"

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

/// Measures how long a program ran on the host's cores, and how long its threads were ready to run
/// but had no core.
///
/// The kernel counts a wait when it ends: a current wait is not included. Time that a hypervisor
/// takes from the host counts as run, not as waited.
namespace atrium {

/// One line of /proc/PID/task/TID/schedstat.
struct SchedStat {
    std::uint64_t run_ns = 0;     // on a core
    std::uint64_t waited_ns = 0;  // ready to run, without a core
    std::uint64_t num_runs = 0;   // times that it got a core
};

/// Parses such a line. Returns nullopt if it is not three decimal numbers, or if the numbers are
/// zero because the kernel does not count.
std::optional<SchedStat> parse_schedstat(std::string_view text);

/// Processor time of a program, all threads together.
struct ProcessorUse {
    std::uint64_t run_ns = 0;         // since the program's start
    std::uint64_t waited_ns = 0;      // since the program's start; sum over the threads
    double run_per_s = 0.0;           // cores used in the last interval
    double waited_per_s = 0.0;        // seconds waited per second of it, sum over the threads
    double longest_wait_per_s = 0.0;  // of the thread that waited longest, at most 1
    bool is_waiting_known = false;    // false: the kernel does not count waits; they are invalid
    std::int16_t nice = 0;            // -20 is the highest priority, 19 the lowest

    bool operator==(const ProcessorUse&) const = default;
};

/// Measures this process from /proc: one small file per thread, intended for once a second. Totals
/// never decrease: ended threads stay counted. The wait of a thread between the last reading and
/// its end is lost; its run time is not. Not thread-safe.
class ProcessorMeter {
public:
    using Clock = std::chrono::steady_clock;

    /// `tasks` is a folder with one folder per thread, each with a file `schedstat`.
    explicit ProcessorMeter(std::string tasks = "/proc/self/task",
                            Clock::time_point now = Clock::now());

    /// Returns the current totals, and the rates since the last reading (at first since
    /// construction). Returns the last result if that is less than kLeastInterval ago: a wait is
    /// counted when it ends, thus a short interval can contain the end of a wait of seconds.
    ProcessorUse update(Clock::time_point now = Clock::now());
    static constexpr std::chrono::milliseconds kLeastInterval{200};

private:
    struct Waits {
        std::uint64_t sum_ns = 0;      // of all threads, since the last reading
        std::uint64_t longest_ns = 0;  // largest of any thread
        bool is_known = false;
    };
    Waits read_threads();

    std::string tasks_;
    std::map<pid_t, SchedStat> threads_;  // of the last reading
    ProcessorUse use_;
    Clock::time_point last_;
};

}  // namespace atrium
