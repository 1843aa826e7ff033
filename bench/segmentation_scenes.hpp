#pragma once

#include <opencv2/core.hpp>

#include <functional>
#include <string>
#include <vector>

namespace atrium::bench {

/// One picture to be segmented, and what is known of it. Pictures are packed BGR.
struct SegmentationScene {
    std::string scene;  // rows of one scene are averaged
    std::string camera;
    std::vector<cv::Mat> empty;        // the empty room, to learn from
    std::vector<cv::Mat> empty_later;  // more of it, to be told empty; may be none
    cv::Mat picture;
    cv::Mat truth;   // 255 where somebody is; empty: not known
    cv::Mat shadow;  // 255 where the picture is darker than the empty room by 7 % at least, and
                     // nobody is; empty: not known
};

/// Calls `visit` for each scene that is there: recordings with real people, where
/// `recordings` exists, and simulated rooms of `rig` under noise and other light. False where
/// something could not be read or rendered.
bool visit_segmentation_scenes(const std::string& recordings,
                               const std::string& rig,
                               const std::function<void(const SegmentationScene&)>& visit);

}  // namespace atrium::bench
