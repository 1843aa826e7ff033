#include "site_node/camera_status.hpp"

#include "core/app/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace atrium::site_node {

OffsetBoard::OffsetBoard(const config::Rig& rig, bool warns)
    : offsets_ns_(rig.cameras.size()), is_reported_(rig.cameras.size(), warns ? 0 : 1) {
    for (const auto& camera : rig.cameras) names_.push_back(camera.name);
}

void OffsetBoard::update(const capture::CameraOffsets& offsets, std::chrono::nanoseconds largest) {
    for (std::size_t i = 0; i < offsets_ns_.size(); ++i) {
        offsets_ns_[i] = offsets.offset(i).count();
        if (is_reported_[i] != 0 || std::abs(offsets_ns_[i]) < largest.count()) continue;
        is_reported_[i] = 1;
        // the true offset may be one period less, from another trigger
        app::log::warn(
            "camera '{}' takes its pictures {:+.1f} ms from the others, the most that "
            "capture.tolerance_ms allows, and may show another instant; let the site trigger "
            "(capture.trigger = \"software\"), which measures delays, or give all cameras one "
            "clock (PTP)",
            names_[i],
            offset_ms(i));
    }
}

double OffsetBoard::offset_ms(std::size_t camera) const {
    return static_cast<double>(offsets_ns_[camera]) * 1e-6;
}

std::string OffsetBoard::line() const {
    std::string line;
    for (std::size_t i = 0; i < names_.size(); ++i)
        line += fmt::format("{}{}={:+.3f}", i == 0 ? "" : " ", names_[i], offset_ms(i));
    return line;
}

std::vector<bus::CameraStatus> camera_statuses(const std::vector<capture::CameraCounters>& counters,
                                               const OffsetBoard& offsets) {
    std::vector<bus::CameraStatus> cameras = camera_statuses(counters);
    for (std::size_t i = 0; i < cameras.size(); ++i) cameras[i].offset_ms = offsets.offset_ms(i);
    return cameras;
}

std::vector<bus::CameraStatus> camera_statuses(
    const std::vector<capture::CameraCounters>& counters) {
    std::vector<bus::CameraStatus> cameras;
    const auto now = std::chrono::steady_clock::now();
    for (const capture::CameraCounters& counted : counters) {
        bus::CameraStatus& camera = cameras.emplace_back();
        camera.name = counted.name;
        camera.connected = counted.connected;
        camera.num_received = counted.num_received;
        camera.num_incomplete = counted.num_incomplete;
        camera.num_resent = counted.num_resent;
        camera.num_late = counted.num_late;
        camera.num_dropped = counted.num_dropped;
        camera.num_backwards = counted.num_backwards;
        camera.num_reconnects = counted.num_reconnects;
        if (!counted.last_picture) continue;
        const std::chrono::duration<double, std::milli> age = now - *counted.last_picture;
        camera.last_picture_age_ms = std::max(age.count(), 0.0);  // it may be newer than `now`
    }
    return cameras;
}

}  // namespace atrium::site_node
