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

/// Counts how the streams of the sites arrive, for the sites to adapt to it. Who owns it says when
/// something arrives, and what the time is. Not thread-safe.
///
/// What waits for a viewer that lacks processor time is no queue in the network. So beside the
/// measured delay stands what of it is sure: a frame whose first sample is taken now came to this
/// host after the last moment at which nothing waited here, whatever else is not known.
class Feedback {
public:
    static constexpr std::chrono::milliseconds kPeriod{200};
    static constexpr std::chrono::milliseconds kOnTime{10};

    /// What came was taken; `has_all`: nothing that had reached this host by that time still waits.
    /// To be said more often than every `kOnTime`.
    void looked(Timestamp time, bool has_all);
    /// A mesh or texture of `num_bytes` of payload arrived. `written`: by the clock of the site.
    void arrived(const std::string& site,
                 Timestamp written,
                 Timestamp capture_time,
                 std::size_t num_bytes,
                 Timestamp now);
    /// With what arrived, a frame is complete.
    void completed(const std::string& site,
                   std::uint64_t frame_id,
                   Timestamp capture_time,
                   Timestamp now);
    /// Frames that will stay incomplete, and samples that came when a newer frame was complete.
    void lost(const std::string& site, std::uint64_t num_incomplete, std::uint64_t num_late);
    /// Nothing has come of any site, or all are gone.
    bool empty() const { return sites_.empty(); }
    /// Returns whether the site was known.
    bool forget(const std::string& site) { return sites_.erase(site) > 0; }

    /// Hands out one feedback per site of which anything has come, and begins to count anew; does
    /// nothing within kPeriod of the last time. Where something still waits in this host it puts
    /// that off, for another kPeriod at most: what is counted between two moments at which nothing
    /// waits is what the network brought.
    void report(const std::string& viewer,
                Timestamp now,
                const std::function<void(const bus::StreamFeedback&)>& send);

private:
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    struct Site {
        bus::StreamFeedback feedback;
        std::size_t num_bytes = 0;
        Timestamp since;
        double min_ms = kNone;  // since it was written, of any sample
        double min_since_capture_ms = kNone;
        Timestamp newest_capture;
        std::vector<double> sure_ms;  // of each frame's first sample
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
