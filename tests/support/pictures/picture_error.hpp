#pragma once

#include "core/image/image.hpp"

#include <cstdint>
#include <vector>

namespace atrium::test {

/// Difference of a picture from the true one, where `mask` is not 0. All have the mask's size.
struct PictureError {
    double psnr_db = 0.0;        // over blue, green and red; infinite without differences
    double inner_psnr_db = 0.0;  // more than three pixels inside the mask's edge
    double ssim = 1.0;           // of luma
};

/// The windows of the structural similarity (Gaussian, sigma 1.5 px, 11 px wide) weigh only pixels
/// of the mask, and pixels outside have no influence. The result is the mean over the mask.
///
/// Wang, Bovik, Sheikh, Simoncelli. Image Quality Assessment: From Error Visibility to Structural
/// Similarity. IEEE Transactions on Image Processing 13(4), 2004.
PictureError picture_error(const std::vector<std::uint8_t>& true_bgr,
                           const std::vector<std::uint8_t>& shown_bgr,
                           const image::Mask& mask);

}  // namespace atrium::test
