#include "viewer/receive/feedback.hpp"

#include "core/bus/delays_from.hpp"

#include <algorithm>
#include <functional>

namespace atrium::viewer {
namespace {

// A sample this much older than the newest means that the site's clock was set back.
constexpr std::chrono::seconds kMaxDisorder{2};
// Frames per report that may be late because a datagram of each was retransmitted.
constexpr std::size_t kNumSentAgain = 2;

}  // namespace

// Lower bound of the delay. The queue in the network delays all frames of one report by
// about the same time, so the tightest bound of a frame holds for all, apart from retransmissions.
double Feedback::sure_delay_ms(const Site& site) const {
    if (longest_wait_ms_ <= milliseconds(kOnTime)) return site.min_ms;
    if (site.sure_ms.empty()) return site.min_ms - longest_wait_ms_;
    std::vector<double> sure_ms = site.sure_ms;
    const std::size_t rank = std::min(kNumSentAgain, sure_ms.size() - 1);
    const auto at = sure_ms.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(sure_ms.begin(), at, sure_ms.end(), std::greater<>());
    return std::min(*at, site.min_ms);
}

Feedback::Site* Feedback::find_or_add(const std::string& name, Timestamp now) {
    if (const auto known = sites_.find(name); known != sites_.end()) return &known->second;
    if (sites_.size() >= kMaxSites) return nullptr;
    Site& site = sites_[name];
    site.feedback.site = name;
    site.since = now;
    return &site;
}

// A step of the clock falsifies one wait: a short wait counts as on time, a long one does not.
void Feedback::note_wait(Timestamp now) {
    if (taken_all_until_.ns == 0) return;
    longest_wait_ms_ = std::max(longest_wait_ms_, milliseconds(now - taken_all_until_));
}

void Feedback::looked(Timestamp time, bool has_all) {
    last_look_ = time;
    if (!has_all) return;
    note_wait(time);
    taken_all_until_ = time;
}

void Feedback::arrived(const std::string& name,
                       Timestamp written,
                       Timestamp capture_time,
                       std::size_t num_bytes,
                       Timestamp now) {
    Site* site = find_or_add(name, now);
    if (site == nullptr) return;
    ++site->feedback.num_samples;
    site->num_bytes += num_bytes;
    const double delay_ms = milliseconds(now - written);
    site->min_ms = std::min(site->min_ms, delay_ms);
    site->min_since_capture_ms = std::min(
        site->min_since_capture_ms, milliseconds(now - bus::delays_from(capture_time, written)));
    const bool is_disorder =
        capture_time <= site->newest_capture && site->newest_capture - capture_time < kMaxDisorder;
    if (is_disorder) return;  // it may have waited for earlier samples of its frame
    site->newest_capture = capture_time;
    const bool is_on_time = now >= taken_all_until_ && now - taken_all_until_ <= kOnTime;
    site->sure_ms.push_back(
        is_on_time ? delay_ms : std::min(delay_ms, milliseconds(taken_all_until_ - written)));
}

void Feedback::completed(const std::string& name,
                         std::uint64_t frame_id,
                         Timestamp delays_from,
                         Timestamp now) {
    Site* site = find_or_add(name, now);
    if (site == nullptr) return;
    ++site->feedback.num_complete;
    site->feedback.newest_frame_id = frame_id;
    site->complete_ms.push_back(milliseconds(now - delays_from));
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
    feedback.min_delay_ms = feedback.sure_delay_ms = feedback.median_delay_ms = 0.0;
    site.num_bytes = 0;
    site.since = now;
    site.complete_ms.clear();
    site.min_ms = site.min_since_capture_ms = kNone;
    site.sure_ms.clear();
}

void Feedback::report(const std::string& viewer,
                      Timestamp now,
                      const std::function<void(const bus::StreamFeedback&)>& send) {
    // the clock may have been set back
    const auto elapsed = now - last_report_;
    const bool may_wait = taken_all_until_ < last_look_ && elapsed < 2 * kPeriod;
    if (now >= last_report_ && (elapsed < kPeriod || may_wait)) return;
    last_report_ = now;
    note_wait(now);
    for (auto& [name, site] : sites_) {
        bus::StreamFeedback& feedback = site.feedback;
        const double elapsed_s = 1e-3 * milliseconds(now - site.since);
        feedback.viewer = viewer;
        feedback.time = now;
        feedback.payload_bytes_per_s =
            elapsed_s > 0.0 ? static_cast<double>(site.num_bytes) / elapsed_s : 0.0;
        if (feedback.num_samples > 0) {
            feedback.min_delay_ms = site.min_ms;
            feedback.sure_delay_ms = sure_delay_ms(site);
            feedback.median_delay_ms = site.min_since_capture_ms;
        }
        feedback.longest_wait_ms = longest_wait_ms_;
        if (std::vector<double>& delays = site.complete_ms; !delays.empty()) {
            const auto middle = delays.begin() + static_cast<std::ptrdiff_t>(delays.size() / 2);
            std::nth_element(delays.begin(), middle, delays.end());
            feedback.median_delay_ms = *middle;
        }
        send(feedback);
        begin_anew(site, now);
    }
    longest_wait_ms_ = 0.0;
}

}  // namespace atrium::viewer
