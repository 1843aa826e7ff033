#pragma once

#include "core/image/image.hpp"

namespace cv {
class Mat;
}

namespace atrium::capture {

/// Writes which pixels of a decoded mask are people; false if it has neither 8 nor 16 bits per
/// channel. Odd last rows and columns are lost, as in pictures. Foreground is
///
/// - with alpha that varies: what is less than half transparent
/// - in at most eight colours on black, some of them not grey: everything but black
/// - without a value above half of the largest of 8 bits, and with at most eight values beside 0:
///   everything but 0, as in masks of numbers
/// - else what is brighter than half of the largest value; in 16 bits without a value above 255,
///   that of 8 bits.
bool mask_from(const cv::Mat& picture, image::Mask& out);

/// True for a picture in natural colours without transparency, such as a person cut out on black:
/// no brightness tells people from the rest there.
bool is_in_colours(const cv::Mat& picture);

}  // namespace atrium::capture
