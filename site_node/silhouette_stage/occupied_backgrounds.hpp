#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/silhouette_stage/backgrounds.hpp"

#include <stop_token>
#include <vector>

namespace atrium::site_node {

/// Learns the background of `cameras` from pictures with people in it: of a recording from pictures
/// spread over all of it, else from what the source shows during `options.watch_s`. Looks through
/// all cameras of the rig. Logs progress once a second and the quality of each result, and warns
/// about places that were never seen empty, and about rooms whose silhouettes contradict each other
/// (learned_rooms.hpp). Results as in load_or_learn_backgrounds.
std::vector<Expected<segmentation::BackgroundStatistics>> learn_with_people(
    capture::FrameSource& source,
    const std::vector<std::size_t>& cameras,
    const BackgroundOptions& options,
    const segmentation::SegmentationOptions& segmentation,
    const std::stop_token& stop);

}  // namespace atrium::site_node
