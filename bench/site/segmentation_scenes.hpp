#pragma once

#include <opencv2/core.hpp>

#include <functional>
#include <string>
#include <vector>

namespace atrium::bench {

/// One picture to segment, with its ground truth. Pictures are packed BGR.
struct SegmentationScene {
    std::string scene;  // rows of one scene are averaged
    std::string camera;
    std::vector<cv::Mat> empty;  // the empty room, for learning
    // more of the empty room, to test false positives; may be empty
    std::vector<cv::Mat> empty_later;
    cv::Mat picture;
    cv::Mat truth;   // 255 on a person; empty if unknown
    cv::Mat shadow;  // 255 where the picture is darker than the empty room by 7 % at least, without
                     // a person; empty if unknown
};

/// Calls `visit` for each available scene: recordings with real people, if `recordings` exists, and
/// simulated rooms of `rig` with noise and other light. Returns false if a scene could not be read
/// or rendered.
bool visit_segmentation_scenes(const std::string& recordings,
                               const std::string& rig,
                               const std::function<void(const SegmentationScene&)>& visit);

}  // namespace atrium::bench
