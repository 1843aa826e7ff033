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

/// The offsets of the cameras' times as they were learned last. One thread updates, any reads.
class OffsetBoard {
public:
    /// `warns`: an offset that is as large as can be is logged, once per camera.
    OffsetBoard(const config::Rig& rig, bool warns);

    /// `largest` is what offsets are clamped to.
    void update(const capture::CameraOffsets& offsets, std::chrono::nanoseconds largest);

    double offset_ms(std::size_t camera) const;
    /// `camera=offset ...` in ms, for the log.
    std::string line() const;

private:
    std::vector<std::string> names_;
    std::vector<std::atomic<std::int64_t>> offsets_ns_;
    std::vector<std::uint8_t> is_told_;  // per camera; of the thread that updates
};

/// What is said of each camera once a second; `counters` are those of the cameras of `offsets`, in
/// the same order, or none.
std::vector<bus::CameraStatus> camera_statuses(const std::vector<capture::CameraCounters>& counters,
                                               const OffsetBoard& offsets);

}  // namespace atrium::site_node
