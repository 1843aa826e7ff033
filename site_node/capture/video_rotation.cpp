#include "site_node/capture/video_rotation.hpp"

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>

namespace atrium::capture {
namespace {

constexpr bool kTurnsBackwards = CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR == 6;

}  // namespace

int rotation_tag_deg(const cv::VideoCapture& video) {
    const double turn_deg = video.get(cv::CAP_PROP_ORIENTATION_META);
    if (!(std::abs(turn_deg) <= 360.0)) return 0;
    const int clockwise = static_cast<int>(kTurnsBackwards ? -turn_deg : turn_deg);
    return (clockwise + 720) % 360;
}

void correct_rotation(const cv::VideoCapture& video, cv::Mat& picture) {
    if (!kTurnsBackwards || picture.empty()) return;
    const int turn_deg = rotation_tag_deg(video);
    if (turn_deg == 90 || turn_deg == 270) cv::rotate(picture, picture, cv::ROTATE_180);
}

}  // namespace atrium::capture
