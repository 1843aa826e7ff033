#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/segmentation/areas.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {

/// Where people are looked for in the pictures of one camera.
struct CameraAreas {
    std::string name;  // of the camera
    segmentation::SegmentationAreas areas;
};

/// Where what the empty room looks like comes from.
struct BackgroundOptions {
    std::filesystem::path folder;  // of what was learned before; empty: it is learned at each start
    /// Pictures to learn from; 0: all that a recording or a simulated room shows, of live cameras
    /// kNumLiveFrames.
    int num_frames = 0;
    static constexpr int kNumLiveFrames = 60;
};

/// What each camera of `source` sees of the empty room: as it was learned before, or else learned
/// now, live cameras all at the same time. Errors name the camera; all that are not learned yet are
/// kUnavailable once `stop` is requested.
std::vector<Expected<segmentation::BackgroundStatistics>> load_or_learn_backgrounds(
    capture::FrameSource& source,
    const BackgroundOptions& options,
    const segmentation::SegmentationOptions& segmentation,
    std::stop_token stop);

/// Learns all cameras of `source` and keeps in `options.folder` those that could be learned; the
/// error is that of the first that could not. Error kUnavailable once `stop` is requested; nothing
/// is kept then.
Expected<void> learn_backgrounds(capture::FrameSource& source,
                                 const BackgroundOptions& options,
                                 const segmentation::SegmentationOptions& segmentation,
                                 std::stop_token stop);

/// The areas of camera `name`, everywhere where there are none; several entries of one camera add
/// up.
segmentation::SegmentationAreas areas_of(const std::vector<CameraAreas>& areas,
                                         const std::string& name);

}  // namespace atrium::site_node
