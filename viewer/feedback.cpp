#include "viewer/feedback.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::viewer {

Feedback::Site* Feedback::find_or_add(const std::string& name, Timestamp now) {
    if (const auto known = sites_.find(name); known != sites_.end()) return &known->second;
    if (sites_.size() >= kMaxSites) return nullptr;
    Site& site = sites_[name];
    site.feedback.site = name;
    site.since = now;
    return &site;
}

void Feedback::arrived(const std::string& name,
                       Timestamp capture_time,
                       std::size_t num_bytes,
                       Timestamp now) {
    Site* site = find_or_add(name, now);
    if (site == nullptr) return;
    ++site->feedback.num_samples;
    site->num_bytes += num_bytes;
    site->min_ms = std::min(site->min_ms, milliseconds(now - capture_time));
}

void Feedback::completed(const std::string& name,
                         std::uint64_t frame_id,
                         Timestamp capture_time,
                         Timestamp now) {
    Site* site = find_or_add(name, now);
    if (site == nullptr) return;
    ++site->feedback.num_complete;
    site->feedback.newest_frame_id = frame_id;
    site->complete_ms.push_back(milliseconds(now - capture_time));
}

void Feedback::lost(const std::string& name, std::uint64_t num_incomplete, std::uint64_t num_late) {
    const auto site = sites_.find(name);
    if (site == sites_.end()) return;
    site->second.feedback.num_incomplete += static_cast<std::uint32_t>(num_incomplete);
    site->second.feedback.num_late += static_cast<std::uint32_t>(num_late);
}

void Feedback::begin_anew(Site& site, Timestamp now) {
    bus::StreamFeedback& feedback = site.feedback;
    feedback.num_complete = feedback.num_incomplete = feedback.num_late = feedback.num_samples = 0;
    site.num_bytes = 0;
    site.since = now;
    site.complete_ms.clear();
    site.min_ms = std::numeric_limits<double>::infinity();
}

void Feedback::report(const std::string& viewer,
                      Timestamp now,
                      const std::function<void(const bus::StreamFeedback&)>& send) {
    // a clock that was set back must not silence it
    if (now >= last_report_ && now - last_report_ < kPeriod) return;
    last_report_ = now;
    for (auto& [name, site] : sites_) {
        bus::StreamFeedback& feedback = site.feedback;
        const double elapsed_s = 1e-3 * milliseconds(now - site.since);
        feedback.viewer = viewer;
        feedback.time = now;
        feedback.payload_bytes_per_s =
            elapsed_s > 0.0 ? static_cast<double>(site.num_bytes) / elapsed_s : 0.0;
        feedback.min_delay_ms = feedback.median_delay_ms =
            std::isfinite(site.min_ms) ? site.min_ms : 0.0;
        if (std::vector<double>& delays = site.complete_ms; !delays.empty()) {
            const auto middle = delays.begin() + static_cast<std::ptrdiff_t>(delays.size() / 2);
            std::nth_element(delays.begin(), middle, delays.end());
            feedback.median_delay_ms = *middle;
        }
        send(feedback);
        begin_anew(site, now);
    }
}

}  // namespace atrium::viewer
