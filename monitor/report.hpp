#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/messages.hpp"
#include "core/status/bottleneck.hpp"
#include "core/status/figures.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Shows who is in a world and how they fare. An observer: nobody hears of it.
namespace atrium::monitor {

using status::Counter;
using status::Figures;
using status::figures_of;

/// What a running count says now, and how fast it grew lately: never negative, for one that went
/// back began anew; nothing, before there are two readings to compare.
struct Count {
    std::string what;
    std::uint64_t total = 0;
    std::optional<double> per_s;
};

/// What stands between two clocks that a latency compares.
enum class ClockTrust : std::uint8_t {
    kOneClock,        // both times are of one host
    kSynchronised,    // of two hosts, which say that their clocks are right to so and so much
    kUnsynchronised,  // of two hosts of which one does not say so: the figure means nothing
    kUnknown,         // nobody said on which host one of them runs
};

struct Latency {
    std::string stage;
    double median_ms = 0.0;
    std::optional<double> p99_ms;
    std::uint64_t num_samples = 0;  // 0: nothing was measured, the figures mean nothing
    ClockTrust trust = ClockTrust::kOneClock;
    double error_ms = 0.0;  // by which clocks may differ, with kSynchronised
};

struct TopicRate {
    std::string topic;
    double bytes_per_s = 0.0;             // of payload
    std::optional<double> samples_per_s;  // where they are measured
    bool is_measured = false;             // here, from the topic; else its writer says so
};

struct CameraReport {
    std::string name;
    bool connected = false;
    Count received;                     // whole pictures
    double offset_ms = 0.0;             // learned: how much later than the others' its times are
    double last_picture_age_ms = -1.0;  // -1: none came yet
    std::vector<Count> losses;
};

struct ClockReport {
    bool is_synchronised = false;
    double max_error_ms = 0.0;
};

enum class ProgramState : std::uint8_t { kPresent, kSilent, kGone };

/// One program, by kind and name.
struct ProgramReport {
    bus::ProgramKind kind = bus::ProgramKind::kOther;
    std::string name;
    ProgramState state = ProgramState::kPresent;
    double silent_s = 0.0;    // since its last status, where it is silent
    double gone_s = 0.0;      // since it left
    std::string gone_reason;  // empty: not known

    // what it says of itself
    bool is_known = false;  // else host, pid, version and clock are not
    std::string host;
    std::uint32_t pid = 0;
    std::string version;
    std::optional<double> uptime_s;
    std::optional<ClockReport> clock;

    // what it counts; without a status there is none of it
    bool has_status = false;
    std::string rate_unit;  // "metaframes/s", "steps/s", "frames/s"
    double rate = 0.0;
    std::vector<Count> work;
    std::vector<Count> losses;
    std::vector<Latency> latencies;
    std::vector<TopicRate> topics;
    std::vector<CameraReport> cameras;
    std::optional<bus::StreamState> stream;
    std::vector<Figures::Note> notes;
    std::uint64_t resident_bytes = 0;
    ProcessorUse processor;
    double first_output_s = 0.0;  // from the start of the process; 0: none yet
    std::vector<status::Bottleneck> bottlenecks;
};

/// How the stream of one site arrives at one viewer.
struct StreamReport {
    std::string viewer;
    std::string site;
    bool is_silent = false;  // nothing was heard of it for some seconds
    double payload_bytes_per_s = 0.0;
    Count complete;  // frames; totals of a stream run since the monitor began
    std::vector<Count> losses;
    std::vector<Latency> delays;
};

/// All that is known at one moment.
struct Report {
    std::string world;
    Timestamp time;
    std::vector<ProgramReport> programs;  // sites, world servers, viewers, others; each by name
    std::vector<StreamReport> streams;
    std::vector<std::string> notices;
    std::uint64_t num_left_out = 0;  // that claimed to be here when there was no room for them

    /// Programs that are not gone.
    std::size_t num_here() const;
};

}  // namespace atrium::monitor
