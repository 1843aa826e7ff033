#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/messages.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Measures how the streams of the sites arrive, so the sites can adapt to them. The owner reports
/// arrivals and the time. Not thread-safe.
///
/// A sample that waits in a viewer short of processor time is no queue in the network. So the
/// feedback has, beside the measured delay, a lower bound: a frame taken now arrived after the
/// readers were last empty, so its delay is at least that moment minus the time at which it was
/// written.
class Feedback {
public:
    static constexpr std::chrono::milliseconds kPeriod{200};
    static constexpr std::chrono::milliseconds kOnTime{10};

    /// Reports that all readers were emptied. `has_all`: every sample that had reached this host by
    /// `time` was taken. Call it more often than every `kOnTime`.
    void looked(Timestamp time, bool has_all);
    /// Counts a mesh or texture of `num_bytes` of payload. `written` is on the clock of the site.
    void arrived(const std::string& site,
                 Timestamp written,
                 Timestamp capture_time,
                 std::size_t num_bytes,
                 Timestamp now);
    /// Counts a frame that is complete now. `delays_from`: see bus::delays_from.
    void completed(const std::string& site,
                   std::uint64_t frame_id,
                   Timestamp delays_from,
                   Timestamp now);
    /// Counts frames that stay incomplete, and samples that arrived after a newer frame was
    /// complete.
    void lost(const std::string& site, std::uint64_t num_incomplete, std::uint64_t num_late);
    /// True if no site is known.
    bool empty() const { return sites_.empty(); }
    /// Returns whether the site was known.
    bool forget(const std::string& site) { return sites_.erase(site) > 0; }

    /// Sends one feedback per known site and resets the counters. Does nothing within kPeriod of
    /// the last report. Postpones the report by at most another kPeriod while samples may wait in
    /// this host: between two moments at which nothing waits, the counts show what the network
    /// delivered.
    void report(const std::string& viewer,
                Timestamp now,
                const std::function<void(const bus::StreamFeedback&)>& send);

private:
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    struct Site {
        bus::StreamFeedback feedback;
        std::size_t num_bytes = 0;
        Timestamp since;
        double min_ms = kNone;  // minimum from writing to arrival, over all samples
        double min_since_capture_ms = kNone;
        Timestamp newest_capture;
        std::vector<double> sure_ms;  // lower bound for each frame's first sample
        std::vector<double> complete_ms;
    };
    static constexpr std::size_t kMaxSites = 64;

    void note_wait(Timestamp now);
    Site* find_or_add(const std::string& site, Timestamp now);
    double sure_delay_ms(const Site& site) const;
    static void begin_anew(Site& site, Timestamp now);

    std::map<std::string, Site> sites_;
    Timestamp last_report_;
    Timestamp last_look_;
    Timestamp taken_all_until_;
    double longest_wait_ms_ = 0.0;
};

}  // namespace atrium::viewer
