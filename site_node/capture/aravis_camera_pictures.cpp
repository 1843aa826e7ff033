#include "core/base/raw_clock.hpp"
#include "site_node/capture/aravis_camera.hpp"

// Handling and counting of pictures, on the receiving thread.
namespace atrium::capture {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

std::int64_t AravisCamera::now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
        .count();
}

std::int64_t AravisCamera::silence_ns() const { return now_ns() - last_sign_ns_; }

void AravisCamera::note_sign_of_life() {
    last_sign_ns_ = now_ns();
    num_unanswered_ = 0;
}

Timestamp AravisCamera::time_on_site_clock(std::uint64_t device_ns, Timestamp arrival) {
    const std::chrono::nanoseconds now_minus_raw = site_minus_raw();
    const Timestamp own = clock_.on_site_clock(device_ns, arrival, now_minus_raw);
    if (!follows_ptp_) return own;
    const std::lock_guard lock(shared_state_.ptp_mutex);
    return shared_state_.ptp_clock.on_site_clock(device_ns, arrival, now_minus_raw);
}

void AravisCamera::on_incomplete(std::uint64_t device_ns, Timestamp arrival) {
    note_sign_of_life();
    ++num_incomplete_;
    if (!guard_.is_newer(device_ns != 0 ? device_ns : static_cast<std::uint64_t>(arrival.ns)))
        return;
    const Timestamp time = time_on_site_clock(device_ns, arrival);
    const auto taken = is_triggered_by_site() ? trigger_clock_.on_lost_picture(time) : time;
    if (!taken) return;
    CameraFrame lost;
    lost.camera = index_;
    lost.capture_time = *taken;
    shared_state_.mailbox.put(std::move(lost), Clock::now());
}

void AravisCamera::on_picture(StreamPicture picture) {
    note_sign_of_life();
    last_picture_ns_ = last_sign_ns_.load();
    shared_state_.last_picture_ns = last_sign_ns_.load();
    ++num_received_;
    const auto arrival_ns = static_cast<std::uint64_t>(picture.arrival.ns);
    if (!guard_.accept(picture.device_ns != 0 ? picture.device_ns : arrival_ns)) {
        ++num_backwards_;
        return;
    }
    const Timestamp time = time_on_site_clock(picture.device_ns, picture.arrival);
    const auto taken = is_triggered_by_site() ? trigger_clock_.on_picture(time) : time;
    if (!taken) {
        if (is_connected_) ++num_late_;  // otherwise it belongs to a measurement
        return;
    }
    CameraFrame frame;
    frame.camera = index_;
    frame.image = std::move(picture.image);
    frame.capture_time = *taken;
    const auto outcome = shared_state_.mailbox.put(std::move(frame), Clock::now());
    if (outcome == FrameMailbox::Outcome::kReplacedOne) ++num_late_;
}

CameraCounters AravisCamera::counters() const {
    CameraCounters counters;
    counters.name = entry_.name;
    counters.connected = is_connected_;
    counters.num_received = num_received_;
    counters.num_incomplete = num_incomplete_;
    counters.num_late = num_late_;
    counters.num_backwards = num_backwards_;
    counters.num_reconnects = num_reconnects_;
    if (const std::int64_t last_ns = last_picture_ns_; last_ns != 0)
        counters.last_picture = Clock::time_point(std::chrono::nanoseconds(last_ns));
    const std::lock_guard lock(session_mutex_);
    counters.num_resent = former_counts_.num_resent_packets;
    counters.num_dropped = former_counts_.num_without_buffer;
    if (stream_ != nullptr) {
        const StreamCounts counts = stream_->counts();
        counters.num_resent += counts.num_resent_packets;
        counters.num_dropped += counts.num_without_buffer;
    }
    return counters;
}

}  // namespace atrium::capture
