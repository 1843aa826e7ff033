#pragma once

#include "site_node/stream/link_estimator.hpp"

#include <map>
#include <string>
#include <string_view>

namespace atrium::stream {

struct StreamOptions {
    double max_mbit_per_s = 0.0;  // upper limit of the stream; 0: no limit
    double min_mbit_per_s = 2.0;  // no viewer lowers the stream below this, to protect the others
    bool adapt = true;            // to the links of the viewers
};

/// Cap from all viewers and the options.
struct StreamCap {
    Cap cap;
    /// The viewer or the option that sets the cap; empty: no limit. Valid until the links change.
    std::string_view set_by;
    double queue_ms = 0.0;  // on the link to that viewer
};

/// Links to all viewers of a site. The slowest sets the cap. A viewer without a report for one
/// second (paused, suspended or gone) is ignored; its estimate is kept for half a minute. Not
/// thread-safe.
class ViewerLinks {
public:
    explicit ViewerLinks(const StreamOptions& options) : options_(options) {}

    /// `next_bit_per_s` as in LinkEstimator::add. Ignores all viewers beyond 64.
    void add(const std::string& viewer, const LinkReport& report, double next_bit_per_s, Time now);
    void forget(const std::string& viewer) { links_.erase(viewer); }

    StreamCap cap(Time now) const;
    std::size_t size() const { return links_.size(); }

private:
    struct Link {
        LinkEstimator estimator;
        Time last_report;
    };
    static bool is_current(const Link& link, Time now);

    StreamOptions options_;
    std::map<std::string, Link> links_;
};

inline constexpr std::string_view kMaxOption = "stream.max_mbit_per_s";
inline constexpr std::string_view kMinOption = "stream.min_mbit_per_s";

}  // namespace atrium::stream
