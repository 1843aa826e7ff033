#pragma once

namespace cv {
class Mat;
class VideoCapture;
}  // namespace cv

namespace atrium::capture {

/// Degrees clockwise, in [0, 360), by which players turn the pictures of an open video, as the
/// rotation tag of its file says; 0 without a tag. Phones write one.
int rotation_tag_deg(const cv::VideoCapture& video);

/// Completes what OpenCV made of the tag, for a picture that was just read. OpenCV 4.6 turns
/// pictures by 90 or 270 degrees in the wrong direction (opencv/opencv#22088).
void correct_rotation(const cv::VideoCapture& video, cv::Mat& picture);

}  // namespace atrium::capture
