#include "site_node/capture/camera_counters.hpp"

#include <fmt/format.h>

namespace atrium::capture {

CameraCounters since(const CameraCounters& former, const CameraCounters& now) {
    CameraCounters counters = now;
    if (now.num_received < former.num_received) return counters;
    counters.num_received -= former.num_received;
    counters.num_incomplete -= former.num_incomplete;
    counters.num_resent -= former.num_resent;
    counters.num_late -= former.num_late;
    counters.num_dropped -= former.num_dropped;
    counters.num_backwards -= former.num_backwards;
    counters.num_reconnects -= former.num_reconnects;
    return counters;
}

CameraCounters sum(const CameraCounters& former, const CameraCounters& now) {
    CameraCounters counters = now;
    counters.num_received += former.num_received;
    counters.num_incomplete += former.num_incomplete;
    counters.num_resent += former.num_resent;
    counters.num_late += former.num_late;
    counters.num_dropped += former.num_dropped;
    counters.num_backwards += former.num_backwards;
    counters.num_reconnects += former.num_reconnects;
    if (!counters.last_picture) counters.last_picture = former.last_picture;
    return counters;
}

std::string to_line(const CameraCounters& c) {
    return fmt::format(
        "name={} connected={} received={} incomplete={} resent={} late={} dropped={} backwards={} "
        "reconnects={}",
        c.name,
        c.connected ? "yes" : "no",
        c.num_received,
        c.num_incomplete,
        c.num_resent,
        c.num_late,
        c.num_dropped,
        c.num_backwards,
        c.num_reconnects);
}

bool has_faults(const CameraCounters& c) {
    return c.num_incomplete + c.num_resent + c.num_late + c.num_dropped + c.num_backwards +
               c.num_reconnects >
           0;
}

DeliveryCounters::DeliveryCounters(const config::Rig& rig) : cameras_(rig.cameras.size()) {
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        cameras_[i].name = rig.cameras[i].name;
        cameras_[i].connected = true;
    }
}

void DeliveryCounters::count_received(std::size_t camera) {
    const std::lock_guard lock(mutex_);
    ++cameras_[camera].num_received;
    cameras_[camera].last_picture = std::chrono::steady_clock::now();
}

void DeliveryCounters::count_incomplete(std::size_t camera) {
    const std::lock_guard lock(mutex_);
    ++cameras_[camera].num_incomplete;
}

std::vector<CameraCounters> DeliveryCounters::counters() const {
    const std::lock_guard lock(mutex_);
    return cameras_;
}

}  // namespace atrium::capture
