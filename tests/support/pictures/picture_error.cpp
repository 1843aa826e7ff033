#include "tests/support/pictures/picture_error.hpp"

#include <opencv2/imgproc.hpp>

#include <cassert>
#include <cmath>
#include <limits>

namespace atrium::test {
namespace {

constexpr int kOutlinePx = 3;  // the inside begins this far inside the mask's edge

cv::Mat picture_of(const std::vector<std::uint8_t>& bgr, const image::Mask& mask) {
    assert(bgr.size() == 3 * mask.data.size());
    return {mask.height, mask.width, CV_8UC3, const_cast<std::uint8_t*>(bgr.data())};
}

cv::Mat luma_of(const cv::Mat& bgr) {
    cv::Mat grey;
    cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
    grey.convertTo(grey, CV_64F);
    return grey;
}

// Means over windows, of weighted pixels only.
class WindowMean {
public:
    explicit WindowMean(const cv::Mat& weights) : weights_(weights) {
        blur(weights, norm_);
        norm_ = cv::max(norm_, 1e-12);
    }
    cv::Mat of(const cv::Mat& values) const {
        cv::Mat sum;
        blur(values.mul(weights_), sum);
        return sum / norm_;
    }

private:
    static void blur(const cv::Mat& in, cv::Mat& out) {
        cv::GaussianBlur(in, out, {11, 11}, 1.5, 1.5, cv::BORDER_REPLICATE);
    }
    cv::Mat weights_;
    cv::Mat norm_;
};

double ssim(const cv::Mat& a, const cv::Mat& b, const cv::Mat& weights) {
    const WindowMean mean(weights);
    const cv::Mat mean_a = mean.of(a);
    const cv::Mat mean_b = mean.of(b);
    const cv::Mat var_a = mean.of(a.mul(a)) - mean_a.mul(mean_a);
    const cv::Mat var_b = mean.of(b.mul(b)) - mean_b.mul(mean_b);
    const cv::Mat covar = mean.of(a.mul(b)) - mean_a.mul(mean_b);
    const double c1 = 0.01 * 255 * 0.01 * 255;
    const double c2 = 0.03 * 255 * 0.03 * 255;
    cv::Mat above = (2.0 * mean_a.mul(mean_b) + c1).mul(2.0 * covar + c2);
    cv::Mat below = (mean_a.mul(mean_a) + mean_b.mul(mean_b) + c1).mul(var_a + var_b + c2);
    const cv::Mat similarity = above / below;
    return similarity.dot(weights) / cv::sum(weights)[0];
}

double psnr_db(const std::vector<std::uint8_t>& true_bgr,
               const std::vector<std::uint8_t>& shown_bgr,
               const image::Mask& mask) {
    double sum_sq = 0.0;
    std::size_t num = 0;
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        if (mask.data[i] == 0) continue;
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c, ++num) {
            const double difference = static_cast<double>(true_bgr[c]) - shown_bgr[c];
            sum_sq += difference * difference;
        }
    }
    if (!(sum_sq > 0.0)) return std::numeric_limits<double>::infinity();
    return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(num) / sum_sq);
}

}  // namespace

PictureError picture_error(const std::vector<std::uint8_t>& true_bgr,
                           const std::vector<std::uint8_t>& shown_bgr,
                           const image::Mask& mask) {
    PictureError error;
    error.psnr_db = psnr_db(true_bgr, shown_bgr, mask);
    const cv::Mat weights(
        mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.data.data()));
    image::Mask inner(mask.width, mask.height);
    cv::Mat eroded(mask.height, mask.width, CV_8U, inner.data.data());
    cv::erode(weights, eroded, cv::Mat::ones(2 * kOutlinePx + 1, 2 * kOutlinePx + 1, CV_8U));
    error.inner_psnr_db = psnr_db(true_bgr, shown_bgr, inner);
    if (cv::countNonZero(weights) == 0) return error;
    const cv::Rect part = cv::boundingRect(weights);
    cv::Mat shares;
    weights(part).convertTo(shares, CV_64F, 1.0 / 255.0);
    error.ssim = ssim(luma_of(picture_of(true_bgr, mask)(part)),
                      luma_of(picture_of(shown_bgr, mask)(part)),
                      shares);
    return error;
}

}  // namespace atrium::test
