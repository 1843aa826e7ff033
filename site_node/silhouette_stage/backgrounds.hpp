#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {

/// Source of the background model: a folder with models learned before, or the pictures themselves.
struct BackgroundOptions {
    std::filesystem::path folder;  // of the kept models; empty: learn at every start
    /// "empty": pictures of the empty room; "people": the room with people in it; "auto": of the
    /// empty room if the source has any of this camera, else with people.
    std::string from = "auto";
    /// Pictures to learn from. 0, of the empty room: every picture that a recording or simulated
    /// room shows; kNumLiveFrames for live cameras. 0, with people: kNumWithPeople.
    int num_frames = 0;
    /// With people: how long live cameras and simulated rooms are watched. A recording is read as a
    /// whole.
    double watch_s = 60.0;
    static constexpr int kNumLiveFrames = 60;
    static constexpr int kNumWithPeople = 100;
};

/// Returns the background of each of `cameras`: loaded from `options.folder`, or learned now if it
/// is not there. A recording may have the rooms with which it was made (`learned_rooms`): they
/// count as `folder` if none is given, and `from` is "auto". Live cameras learn in parallel. Errors
/// name the camera. Once `stop` is requested, every camera not yet learned has error kUnavailable.
std::vector<Expected<segmentation::BackgroundStatistics>> load_or_learn_backgrounds(
    capture::FrameSource& source,
    const std::vector<std::size_t>& cameras,
    const BackgroundOptions& options,
    const segmentation::SegmentationOptions& segmentation,
    std::stop_token stop);

/// Learns the background of all cameras of `source` and writes it to `options.folder`. If a camera
/// fails, the others are still kept, and the result is the first error. Error kUnavailable once
/// `stop` is requested: nothing is kept.
Expected<void> learn_backgrounds(capture::FrameSource& source,
                                 const BackgroundOptions& options,
                                 const segmentation::SegmentationOptions& segmentation,
                                 std::stop_token stop);

}  // namespace atrium::site_node
