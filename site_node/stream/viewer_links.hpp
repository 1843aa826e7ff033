#pragma once

#include "site_node/stream/link_estimator.hpp"

#include <map>
#include <string>
#include <string_view>

namespace atrium::stream {

struct StreamOptions {
    double max_mbit_per_s = 0.0;  // what the stream may take at most; 0: no limit
    double min_mbit_per_s = 2.0;  // no viewer brings it below that, lest one ruins it for all
    bool adapt = true;            // to what the networks of the viewers carry
};

/// What all viewers and the options together allow.
struct StreamCap {
    Cap cap;
    /// A viewer's name, which is valid until the next change of the links, or the option that is
    /// the limit; empty: no limit.
    std::string_view set_by;
    double queue_ms = 0.0;  // on the way to that viewer
};

/// The ways to all viewers of a site. The slowest one sets the cap. A viewer that reported nothing
/// for a second (it stands still, its machine sleeps, it is gone) has no say; what was known of its
/// way is kept for half a minute. Not thread-safe.
class ViewerLinks {
public:
    explicit ViewerLinks(const StreamOptions& options) : options_(options) {}

    /// `next_bit_per_s` as for LinkEstimator::add. Beyond 64 viewers, further ones are ignored.
    void add(const std::string& viewer, const LinkReport& report, double next_bit_per_s, Time now);
    void forget(const std::string& viewer) { links_.erase(viewer); }

    StreamCap cap(Time now) const;
    std::size_t size() const { return links_.size(); }

private:
    struct Link {
        LinkEstimator estimator;
        Time last_report;
    };
    static bool has_say(const Link& link, Time now);

    StreamOptions options_;
    std::map<std::string, Link> links_;
};

inline constexpr std::string_view kMaxOption = "stream.max_mbit_per_s";
inline constexpr std::string_view kMinOption = "stream.min_mbit_per_s";

}  // namespace atrium::stream
