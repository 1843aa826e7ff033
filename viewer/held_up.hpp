#pragma once

#include "core/base/timestamp.hpp"

#include <chrono>
#include <map>
#include <optional>
#include <string>

namespace atrium::viewer {

/// Finds frames that were held up on their way: those in queues when a site, a viewer or the link
/// between them had stopped and goes on. A frame that comes more than `kMaxMore` later after its
/// capture than the quickest of its site is such a one, unless all have been that late for
/// `kGetsUsedTo`: then it is the stream that is slow, or a clock that was set. Clocks of two hosts
/// need not agree. Not thread-safe.
class HeldUp {
public:
    static constexpr std::chrono::nanoseconds kMaxMore = std::chrono::seconds(1);
    static constexpr std::chrono::nanoseconds kGetsUsedTo = std::chrono::milliseconds(500);

    /// A frame of the site that was captured at `capture_time`, on the site's clock, is complete at
    /// `now`, on ours. True: it was held up.
    bool add(const std::string& site, Timestamp capture_time, Timestamp now);
    /// The site is gone: whatever comes from it next is new.
    void forget(const std::string& site) { sites_.erase(site); }

private:
    struct Site {
        std::chrono::nanoseconds best{0};  // shortest delay, creeping up with time
        Timestamp seen;
        std::optional<Timestamp> late_since;
    };
    std::map<std::string, Site> sites_;
};

}  // namespace atrium::viewer
