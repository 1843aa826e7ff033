#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>
#include <map>
#include <optional>
#include <string>

namespace atrium::viewer {

/// Detects frames that waited in a queue while a site, a viewer or the link between them had
/// stopped. A frame is stale if its delay exceeds the shortest delay of its site by more than
/// `kMaxMore`. If all frames are that late for `kGetsUsedTo`, the stream is slow or a clock was
/// set, and the new delay becomes the reference. The clocks of two hosts need not agree. Not
/// thread-safe.
class StaleFrames {
public:
    static constexpr std::chrono::nanoseconds kMaxMore = std::chrono::seconds(1);
    static constexpr std::chrono::nanoseconds kGetsUsedTo = std::chrono::milliseconds(500);

    /// Adds a frame of `site`, whose delay counts from `delays_from` on the site's clock
    /// (bus::delays_from), complete at `now` on the local clock. Returns whether it is stale.
    bool add(const std::string& site, Timestamp delays_from, Timestamp now);
    /// Forgets a site. Its next frame is a new start.
    void forget(const std::string& site) { sites_.erase(site); }

private:
    struct Site {
        std::chrono::nanoseconds best{0};  // shortest delay; grows slowly with time
        Timestamp seen;
        std::optional<Timestamp> late_since;
    };
    std::map<std::string, Site> sites_;
};

}  // namespace atrium::viewer
