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
    int num_frames = 0;            // pictures to learn from; 0: all that the source shows
};

/// What camera `camera` sees of the empty room: as it was learned before, or else learned now.
/// Errors name the camera.
Expected<segmentation::BackgroundStatistics> load_or_learn_background(
    capture::FrameSource& source,
    std::size_t camera,
    const BackgroundOptions& options,
    const segmentation::SegmentationOptions& segmentation,
    std::stop_token stop);

/// Learns all cameras of `source` and keeps them in `options.folder`. Error kUnavailable once
/// `stop` is requested; what was learned until then is kept.
Expected<void> learn_backgrounds(capture::FrameSource& source,
                                 const BackgroundOptions& options,
                                 const segmentation::SegmentationOptions& segmentation,
                                 std::stop_token stop);

/// The areas of camera `name`, everywhere where there are none; several entries of one camera add
/// up.
segmentation::SegmentationAreas areas_of(const std::vector<CameraAreas>& areas,
                                         const std::string& name);

}  // namespace atrium::site_node
