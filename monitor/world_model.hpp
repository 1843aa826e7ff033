#pragma once

#include "core/bus/bus.hpp"
#include "core/bus/messages.hpp"
#include "core/status/figures.hpp"
#include "monitor/clock_trust.hpp"
#include "monitor/rate_window.hpp"
#include "monitor/report.hpp"

#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace atrium::monitor {

/// What is known of one world: takes what was heard and when, gives a Report. No network and no
/// clock of its own; one thread. Its memory is bounded whatever comes.
class WorldModel {
public:
    using Clock = std::chrono::steady_clock;

    static constexpr std::size_t kMaxPrograms = 256;      // of all kinds; more are counted
    static constexpr std::size_t kMaxStreams = 1024;      // viewers times sites
    static constexpr std::size_t kMaxInstances = 8;       // processes that claim one name
    static constexpr std::size_t kMaxNotices = 8;         // of each sort
    static constexpr std::chrono::seconds kShowGone{10};  // for so long after it left
    static constexpr std::chrono::seconds kSilence{3};    // between statuses of one that is well
    static constexpr std::chrono::seconds kKeepNotice{60};

    explicit WorldModel(std::string world) : world_(std::move(world)) {}

    void see(const bus::Presence& presence, Clock::time_point now);
    void gone(const bus::Presence& key, bus::Ending how, Clock::time_point now);

    void see(const bus::SiteStatus& status, Clock::time_point now);
    void see(const bus::WorldStatus& status, Clock::time_point now);
    void see(const bus::ViewerStatus& status, Clock::time_point now);
    /// The writer of its statuses has left; where it is known to be here otherwise that is nothing.
    void status_gone(bus::ProgramKind kind,
                     const std::string& name,
                     bus::Ending how,
                     Clock::time_point now);

    void see(const bus::StreamFeedback& feedback, Clock::time_point now);
    void gone(const bus::StreamFeedback& key);

    /// One sample of `topic` was read here; `writer` is who wrote it.
    void measured(const std::string& topic,
                  bus::ProgramKind kind,
                  const std::string& writer,
                  std::size_t payload_bytes,
                  Clock::time_point now);
    /// Samples that were refused here.
    void rejected(const bus::TakeReport& report, Clock::time_point now);
    /// Something that the user has to know; kept for a minute.
    void notice(const std::string& line, Clock::time_point now);

    /// `time` is that of this host's clock.
    Report report(Clock::time_point now, Timestamp time);

private:
    using ProgramKey = std::pair<bus::ProgramKind, std::string>;
    struct Measured {
        RateWindow bytes;
        RateWindow samples;
    };
    struct Program {
        std::map<std::uint64_t, bus::Presence> instances;
        std::optional<std::uint64_t> instance;  // of which the figures are
        std::optional<Figures> figures;
        std::optional<Figures> before;  // of the same process
        Clock::time_point figures_at;
        Clock::time_point seen_at;
        std::map<std::string, Measured> measured;  // by topic
        std::optional<Clock::time_point> gone_at;
        std::string gone_reason;
        std::optional<bus::Presence> last_presence;  // that held the name
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
    std::set<std::string> report_notices_;  // of the report that is being made
    std::uint64_t num_left_out_ = 0;
};

}  // namespace atrium::monitor
