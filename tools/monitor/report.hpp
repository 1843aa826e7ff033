#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/messages.hpp"
#include "core/status/bottleneck.hpp"
#include "core/status/figures.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Reports the programs in a world and their health. A passive observer: no other program notices
/// it.
namespace atrium::monitor {

using status::Counter;
using status::Figures;
using status::figures_of;

/// A counter and its recent growth. The rate is never negative, because a counter that decreased
/// was restarted. It is empty before the second reading.
struct Count {
    std::string what;
    std::uint64_t total = 0;
    std::optional<double> per_s;
};

/// Relation of the two clocks of a latency.
enum class ClockTrust : std::uint8_t {
    kOneClock,        // both times are of one host
    kSynchronised,    // two hosts that report synchronised clocks with a known error
    kUnsynchronised,  // two hosts, at least one not synchronised: the latency means nothing
    kUnknown,         // the host of one of them is unknown
};

struct Latency {
    std::string stage;
    double median_ms = 0.0;
    std::optional<double> p99_ms;
    std::uint64_t num_samples = 0;  // 0: no measurement, the other values mean nothing
    ClockTrust trust = ClockTrust::kOneClock;
    double error_ms = 0.0;  // possible difference of the clocks, with kSynchronised
};

struct TopicRate {
    std::string topic;
    double bytes_per_s = 0.0;             // of payload
    std::optional<double> samples_per_s;  // only if measured
    bool is_measured = false;             // measured here; else reported by the writer
};

struct CameraReport {
    std::string name;
    bool connected = false;
    Count received;  // complete pictures
    /// Learned: how much later its timestamps are than those of the other cameras.
    double offset_ms = 0.0;
    double last_picture_age_ms = -1.0;  // -1: no picture yet
    std::vector<Count> losses;
};

struct ClockReport {
    bool is_synchronised = false;
    double max_error_ms = 0.0;
};

enum class ProgramState : std::uint8_t { kPresent, kSilent, kGone };

/// One program, identified by kind and name.
struct ProgramReport {
    bus::ProgramKind kind = bus::ProgramKind::kOther;
    std::string name;
    ProgramState state = ProgramState::kPresent;
    double silent_s = 0.0;    // since its last status, with kSilent
    double gone_s = 0.0;      // since it left
    std::string gone_reason;  // empty: unknown

    // from its presence
    bool is_known = false;  // false: host, pid, version and clock are unknown
    std::string host;
    std::uint32_t pid = 0;
    std::string version;
    std::optional<double> uptime_s;
    std::optional<ClockReport> clock;

    // from its status
    bool has_status = false;
    std::string rate_unit;  // "metaframes/s", "steps/s", "frames/s"
    double rate = 0.0;
    std::vector<Count> work;
    std::vector<Count> losses;
    std::vector<Latency> latencies;
    std::vector<TopicRate> topics;
    std::vector<CameraReport> cameras;
    std::optional<bus::StreamState> stream;
    std::optional<bus::RigCoherence> coherence;
    std::vector<bus::HostStatus> hosts;  // of a site on several
    std::vector<Figures::Alarm> alarms;
    std::vector<Figures::Note> notes;
    std::uint64_t resident_bytes = 0;
    ProcessorUse processor;
    double first_output_s = 0.0;  // from the start of the process; 0: no output yet
    std::vector<status::Bottleneck> bottlenecks;
};

/// Arrival of the stream of one site at one viewer.
struct StreamReport {
    std::string viewer;
    std::string site;
    bool is_silent = false;  // no feedback for some seconds
    double payload_bytes_per_s = 0.0;
    Count complete;  // complete frames; the total counts from the start of the monitor
    std::vector<Count> losses;
    std::vector<Latency> delays;
};

/// State of the world at one moment.
struct Report {
    std::string world;
    Timestamp time;
    /// Sites, world servers, viewers, others, camera nodes; each sorted by name.
    std::vector<ProgramReport> programs;
    std::vector<StreamReport> streams;
    std::vector<std::string> notices;
    std::uint64_t num_left_out = 0;  // programs and streams ignored for lack of room

    /// Number of programs that are not gone.
    std::size_t num_here() const;
};

}  // namespace atrium::monitor
