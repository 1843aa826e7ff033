#include "site_node/stream/viewer_links.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::stream {
namespace {

constexpr std::chrono::seconds kSilent{1};
constexpr std::chrono::seconds kForgotten{30};
constexpr std::size_t kMaxViewers = 64;
constexpr double kMega = 1e6;

}  // namespace

bool ViewerLinks::is_current(const Link& link, Time now) {
    return now - link.last_report <= kSilent;
}

void ViewerLinks::add(const std::string& viewer,
                      const LinkReport& report,
                      double next_bit_per_s,
                      Time now) {
    if (!options_.adapt) return;
    std::erase_if(links_,
                  [&](const auto& entry) { return now - entry.second.last_report > kForgotten; });
    if (const auto known = links_.find(viewer); known != links_.end()) {
        known->second.estimator.add(report, next_bit_per_s, now);
        known->second.last_report = now;
        return;
    }
    if (links_.size() >= kMaxViewers || report.num_samples == 0) return;
    links_.emplace(viewer, Link{LinkEstimator(report, kMega * options_.min_mbit_per_s, now), now});
}

StreamCap ViewerLinks::cap(Time now) const {
    StreamCap out;
    const double max = kMega * options_.max_mbit_per_s;
    const double min = kMega * options_.min_mbit_per_s;
    double least = std::numeric_limits<double>::infinity();
    double least_paced = least;
    for (const auto& [viewer, link] : links_) {
        if (!is_current(link, now)) continue;
        least_paced = std::min(least_paced, link.estimator.paced_bit_per_s());
        if (link.estimator.bit_per_s() >= least) continue;
        least = link.estimator.bit_per_s();
        out.set_by = viewer;
        out.queue_ms = link.estimator.queue_ms();
    }
    if (least < min) {
        least = min;
        out.set_by = kMinOption;
    }
    if (max > 0.0 && max <= least) {
        least = max;
        out.set_by = kMaxOption;
        out.queue_ms = 0.0;
    }
    if (!std::isfinite(least)) return out;
    out.cap = {least, std::clamp(least_paced, std::min(min, least), least)};
    return out;
}

}  // namespace atrium::stream
