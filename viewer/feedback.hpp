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
class Feedback {
public:
    static constexpr std::chrono::milliseconds kPeriod{200};

    /// A mesh or texture of `num_bytes` of payload arrived.
    void arrived(const std::string& site,
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
    /// Returns whether the site was known.
    bool forget(const std::string& site) { return sites_.erase(site) > 0; }

    /// Hands out one feedback per site of which anything has come, and begins to count anew; does
    /// nothing within kPeriod of the last time.
    void report(const std::string& viewer,
                Timestamp now,
                const std::function<void(const bus::StreamFeedback&)>& send);

private:
    struct Site {
        bus::StreamFeedback feedback;
        std::size_t num_bytes = 0;
        Timestamp since;
        double min_ms = std::numeric_limits<double>::infinity();  // of any sample
        std::vector<double> complete_ms;
    };
    static constexpr std::size_t kMaxSites = 64;

    Site* find_or_add(const std::string& site, Timestamp now);
    static void begin_anew(Site& site, Timestamp now);

    std::map<std::string, Site> sites_;
    Timestamp last_report_;
};

}  // namespace atrium::viewer
