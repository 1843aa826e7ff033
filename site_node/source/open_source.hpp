#pragma once

#include "simulation/room_config.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/source/capture_config.hpp"

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {

/// Opens the frame source that the configuration names. Progress and warnings go to the log.
Expected<std::unique_ptr<capture::FrameSource>> open_source(const CaptureConfig& config,
                                                            const simulation::RoomConfig& room,
                                                            std::stop_token stop);

/// Opens the frame source with only these cameras of its rig, given by name; it begins to count its
/// cameras there. All hosts of a site show the same instant at the same time of their clocks:
/// recordings and simulated rooms count them from the Unix epoch, and software triggers fire then.
Expected<std::unique_ptr<capture::FrameSource>> open_aligned_source(
    const CaptureConfig& config,
    const simulation::RoomConfig& room,
    const std::vector<std::string>& cameras,
    std::stop_token stop);

/// Like `open_source`, for cameras that are not calibrated yet: only names, sizes and the rate of
/// the source's rig are known. Live cameras need no `[[capture.camera]]`: without any, all that
/// answer are taken, named by their serial numbers. Of `capture.rig`, if the file exists, they take
/// the sizes; else they send their whole sensors. All must be there. A recording needs no rig.toml;
/// a simulated room needs its rig.
Expected<std::unique_ptr<capture::FrameSource>> open_uncalibrated_source(
    const CaptureConfig& config, const simulation::RoomConfig& room, std::stop_token stop);

}  // namespace atrium::site_node
