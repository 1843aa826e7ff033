#pragma once

#include "core/status/figures.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

/// Finds what slows a program down: its machine, its work or the network. The same rules and
/// thresholds serve all programs that report it.
namespace atrium::status {

/// A program is short of processor time if one of its threads waits for a core for this share of
/// the time. At 30 Hz that is 6.7 ms of each period of 33 ms, possibly in each stage.
inline constexpr double kShortOfProcessor = 0.2;

/// A program is overloaded if it loses this share of its due work because it was still busy. A
/// single hiccup, one of 30 metaframes in a second, is less.
inline constexpr double kOverloaded = 0.05;

/// A program that is short of processor time and uses less than this share of its host's cores is
/// held up by other programs: they use more than it does.
inline constexpr double kLargestUser = 0.5;

/// An overloaded program uses about one core, since one of its threads never rests. If it loses
/// work and uses fewer cores than this, it stood still: it or its host was stopped.
inline constexpr double kBusyCores = 0.5;

/// False if the kernel does not count waits.
bool is_short_of_processor(const ProcessorUse& use);

/// Formats the use for people: "0.81 cores", "waited 43 % (all threads 121 %)", "nice 5".
std::vector<std::string> processor_items(const ProcessorUse& use);

/// Formats the fields of a program's last log line: "processor_s=12.3 waited_s=0.4
/// first_output_s=1.20".
std::string process_fields(const ProcessorUse& use, double first_output_s);

enum class Cause { kMachine, kWork, kMachineOrWork, kNetwork, kStoodStill };

/// Name for logs and JSON: "machine_too_slow", "work_too_slow", "machine_or_work_too_slow",
/// "network_too_slow" or "stood_still".
const char* name_of(Cause cause);

struct Bottleneck {
    Cause cause;
    std::string text;  // one line, with figures

    bool operator==(const Bottleneck&) const = default;
};

/// Finds the bottlenecks of a program between two of its reports. Without `before`, or if it is of
/// another process, only the processor is judged. A program that is short of processor time also
/// loses samples: its losses are then not attributed to the network.
///
/// A loss is counted after the wait that caused it. Reports must read their losses before their
/// processor use: then the wait is in the same report, or in the one before.
std::vector<Bottleneck> bottlenecks(const std::optional<Figures>& before, const Figures& now);

/// Tells the user what to do about it. `share_of_host`: part of the host's cores that the program
/// uses.
std::string advice(Cause cause, bus::ProgramKind kind, double share_of_host);

/// Makes a program's log lines about its own overload: the first of each cause at once, further
/// ones of that cause after `kPeriod`, twice that and so on, at most `kLongestPeriod`; a calm of
/// that length begins anew. Leaves out the network, which the streams report.
/// Not thread-safe.
class OverloadLog {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kPeriod{5};
    static constexpr std::chrono::seconds kLongestPeriod{160};

    /// `own_advice` replaces `advice` where it has an answer. `host_cores`: those of this host.
    explicit OverloadLog(bus::ProgramKind kind,
                         std::function<std::string(Cause)> own_advice = {},
                         unsigned host_cores = std::thread::hardware_concurrency())
        : kind_(kind), own_advice_(std::move(own_advice)), host_cores_(std::max(1U, host_cores)) {}

    /// Returns the line to log, if any. Call it after each report of the program.
    std::optional<std::string> look(Figures now, Clock::time_point time);

private:
    bus::ProgramKind kind_;
    std::function<std::string(Cause)> own_advice_;
    unsigned host_cores_;
    std::optional<Figures> before_;
    struct Repeat {
        Clock::time_point last_seen;
        Clock::time_point due;
        std::chrono::seconds period = kPeriod;
    };
    std::map<Cause, Repeat> repeats_;
};

}  // namespace atrium::status
