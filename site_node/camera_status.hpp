#pragma once

#include "core/bus/messages.hpp"
#include "core/config/rig.hpp"
#include "site_node/capture/camera_counters.hpp"
#include "site_node/capture/camera_offsets.hpp"

#include <atomic>
#include <chrono>
#include <string>
#include <vector>

namespace atrium::site_node {

/// Holds the latest time offset of each camera. One thread updates; any thread reads.
class OffsetBoard {
public:
    /// With `warns`, logs each camera whose offset reaches the limit, once per camera.
    OffsetBoard(const config::Rig& rig, bool warns);

    /// `largest` is the limit to which offsets are clamped.
    void update(const capture::CameraOffsets& offsets, std::chrono::nanoseconds largest);

    double offset_ms(std::size_t camera) const;
    /// Returns `camera=offset ...` in ms, for the log.
    std::string line() const;

private:
    std::vector<std::string> names_;
    std::vector<std::atomic<std::int64_t>> offsets_ns_;
    std::vector<std::uint8_t> is_reported_;  // per camera; only the updating thread uses it
};

/// Builds the per-camera part of the status. `counters` are in the camera order of `offsets`, or
/// empty.
std::vector<bus::CameraStatus> camera_statuses(const std::vector<capture::CameraCounters>& counters,
                                               const OffsetBoard& offsets);

/// Without offsets: the host that assembles metaframes learns them.
std::vector<bus::CameraStatus> camera_statuses(
    const std::vector<capture::CameraCounters>& counters);

}  // namespace atrium::site_node
