#pragma once

#include "core/bus/bus.hpp"
#include "core/bus/messages.hpp"
#include "core/status/figures.hpp"
#include "tools/monitor/clock_trust.hpp"
#include "tools/monitor/rate_window.hpp"
#include "tools/monitor/report.hpp"

#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace atrium::monitor {

/// Collects what is known of one world and makes a Report of it. Has no network and no clock. Not
/// thread-safe. Its memory is bounded for any input.
class WorldModel {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr std::size_t kMaxPrograms = 256;  // of all kinds; more are only counted
    static constexpr std::size_t kMaxStreams = 1024;  // viewers times sites
    static constexpr std::size_t kMaxInstances = 8;   // processes that claim one name
    static constexpr std::size_t kMaxNotices = 8;     // of each kind
    /// Time that a program stays listed after it left.
    static constexpr std::chrono::seconds kShowGone{10};
    /// Longest time between two statuses of a healthy program.
    static constexpr std::chrono::seconds kSilence{3};
    static constexpr std::chrono::seconds kKeepNotice{60};

    explicit WorldModel(std::string world) : world_(std::move(world)) {}

    void see(const bus::Presence& presence, Clock::time_point now);
    void gone(const bus::Presence& key, bus::Ending how, Clock::time_point now);

    void see(const bus::SiteStatus& status, Clock::time_point now);
    void see(const bus::WorldStatus& status, Clock::time_point now);
    void see(const bus::ViewerStatus& status, Clock::time_point now);
    void see(const bus::CameraNodeStatus& status, Clock::time_point now);
    void see(const bus::RegionNodeStatus& status, Clock::time_point now);
    /// The writer of the statuses has left. Ignored while a Presence shows that the program is
    /// here.
    void status_gone(bus::ProgramKind kind,
                     const std::string& name,
                     bus::Ending how,
                     Clock::time_point now);

    void see(const bus::StreamFeedback& feedback, Clock::time_point now);
    void gone(const bus::StreamFeedback& key);

    /// Counts one sample of `topic`, read here and written by `writer`.
    void measured(const std::string& topic,
                  bus::ProgramKind kind,
                  const std::string& writer,
                  std::size_t payload_bytes,
                  Clock::time_point now);
    /// Adds a notice about rejected samples.
    void rejected(const bus::TakeReport& report, Clock::time_point now);
    /// Adds a notice for the user. Kept for a minute.
    void notice(const std::string& line, Clock::time_point now);

    /// `time`: time of this host's clock.
    Report report(Clock::time_point now, Timestamp time);

private:
    using ProgramKey = std::pair<bus::ProgramKind, std::string>;
    struct Measured {
        RateWindow bytes;
        RateWindow samples;
    };
    struct Program {
        std::map<std::uint64_t, bus::Presence> instances;
        std::optional<std::uint64_t> instance;  // process that the figures belong to
        std::optional<Figures> figures;
        std::optional<Figures> before;  // same process
        Clock::time_point figures_at;
        Clock::time_point seen_at;
        std::map<std::string, Measured> measured;  // by topic
        std::optional<Clock::time_point> gone_at;
        std::string gone_reason;
        std::optional<bus::Presence> last_presence;  // last holder of the name
    };
    struct Stream {
        bus::StreamFeedback newest;
        std::map<std::string, std::pair<std::uint64_t, RateWindow>> counts;
        Clock::time_point seen_at;
    };

    Program* row(const ProgramKey& key);
    void take(const ProgramKey& key, Figures figures, Clock::time_point now);
    static const bus::Presence* holder(const Program& program);
    static void leave(Program& program, bus::Ending how, Clock::time_point now);
    void forget_the_gone(Clock::time_point now);
    void note_samples(Stream& stream,
                      const char* what,
                      std::uint64_t amount,
                      Clock::time_point now);

    // world_model_report.cpp
    ProgramReport report_of(const ProgramKey& key,
                            const Program& program,
                            Clock::time_point now,
                            Timestamp time);
    static void put_figures(const Program& program, ProgramReport& out);
    void put_latencies(const ProgramKey& key, const Figures& figures, ProgramReport& out);
    StreamReport report_of(const std::pair<std::string, std::string>& key,
                           const Stream& stream,
                           Clock::time_point now);
    std::optional<HostClock> clock_of(bus::ProgramKind kind, const std::string& name) const;
    Comparison compare_with_site(const std::string& site,
                                 bus::ProgramKind kind,
                                 const std::string& name);

    std::string world_;
    std::map<ProgramKey, Program> programs_;
    std::map<std::pair<std::string, std::string>, Stream> streams_;  // viewer, site
    std::deque<std::pair<Clock::time_point, std::string>> notices_;
    std::set<std::string> report_notices_;  // of the current report
    std::uint64_t num_left_out_ = 0;
};

}  // namespace atrium::monitor
