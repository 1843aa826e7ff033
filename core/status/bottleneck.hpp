#pragma once

#include "core/status/figures.hpp"

#include <chrono>
#include <optional>
#include <string>
#include <vector>

/// Says why a program is slower than it should be: its machine, its own work or the network. The
/// rules and thresholds for all programs that report it.
namespace atrium::status {

/// A program is short of processor while one of its threads waits this part of the time for a core.
/// At 30 Hz that is 6.7 ms of each period of 33 ms, and each stage on the way may lose as much.
inline constexpr double kShortOfProcessor = 0.2;

/// A program is overloaded while it loses this part of what is due because it was still busy. A
/// single hiccup, one of 30 metaframes in a second, is less.
inline constexpr double kOverloaded = 0.05;

/// A program whose work takes too long uses about a core, as one of its threads never rests. One
/// that loses as much with less than this stood still: it was stopped, or its host was.
inline constexpr double kBusyCores = 0.5;

bool is_short_of_processor(const ProcessorUse& use);

/// For people: "0.81 cores", "waited 43 % (all threads 121 %)", "nice 5".
std::vector<std::string> processor_items(const ProcessorUse& use);

/// For the last log line of a program: "processor_s=12.3 waited_s=0.4 first_output_s=1.2".
std::string process_fields(const ProcessorUse& use, double first_output_s);

enum class Cause { kMachine, kWork, kMachineOrWork, kNetwork, kStoodStill };

/// "machine_too_slow", "work_too_slow", "machine_or_work_too_slow", "network_too_slow" or
/// "stood_still".
const char* name_of(Cause cause);

struct Bottleneck {
    Cause cause;
    std::string text;  // one line, with figures

    bool operator==(const Bottleneck&) const = default;
};

/// What kept one program back between two of its reports; `before` is of the same process, or
/// nothing. A program that is short of processor loses samples too: its losses are not blamed on
/// the network then.
std::vector<Bottleneck> bottlenecks(const std::optional<Figures>& before, const Figures& now);

/// What a user can do about it.
std::string advice(Cause cause, bus::ProgramKind kind);

/// Makes the log lines of a program about its own overload: the first at once, and further ones
/// at most every `kPeriod`. The network is left out: the streams report it. Not thread-safe.
class OverloadLog {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kPeriod{5};

    explicit OverloadLog(bus::ProgramKind kind) : kind_(kind) {}

    /// After each report of the program: the line that is due, if any.
    std::optional<std::string> look(Figures now, Clock::time_point time);

private:
    bus::ProgramKind kind_;
    std::optional<Figures> before_;
    std::optional<Clock::time_point> last_line_;
};

}  // namespace atrium::status
