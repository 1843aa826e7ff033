#include "tests/golden/picture_difference.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace atrium::golden {
namespace {

cv::Mat lab_of(const renderer::RenderedPicture& picture) {
    const cv::Mat rgba(
        picture.height, picture.width, CV_8UC4, const_cast<std::uint8_t*>(picture.rgba.data()));
    cv::Mat rgb, lab;
    cv::cvtColor(rgba, rgb, cv::COLOR_RGBA2RGB);
    rgb.convertTo(rgb, CV_32F, 1.0 / 255.0);
    cv::GaussianBlur(rgb, rgb, {0, 0}, 1.0);
    cv::cvtColor(rgb, lab, cv::COLOR_RGB2Lab);  // float: L in [0, 100]
    return lab;
}

}  // namespace

PictureDifference picture_difference(const renderer::RenderedPicture& a,
                                     const renderer::RenderedPicture& b) {
    assert(a.width == b.width && a.height == b.height && !a.rgba.empty());
    const cv::Mat lab_a = lab_of(a), lab_b = lab_of(b);
    PictureDifference result;
    result.per_pixel.reserve(lab_a.total());
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            const double distance = cv::norm(lab_a.at<cv::Vec3f>(y, x), lab_b.at<cv::Vec3f>(y, x));
            result.per_pixel.push_back(static_cast<float>(distance));
        }
    }
    std::vector<float> sorted = result.per_pixel;
    std::sort(sorted.begin(), sorted.end());
    const auto num = static_cast<double>(sorted.size());
    result.mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / num;
    result.percentile_99_9 = sorted[static_cast<std::size_t>(0.999 * (num - 1.0))];
    const auto over_5 = std::upper_bound(sorted.begin(), sorted.end(), 5.0F);
    result.share_over_5 = static_cast<double>(sorted.end() - over_5) / num;
    return result;
}

bool is_within(const PictureDifference& difference, const Limits& limits) {
    return difference.mean <= limits.mean && difference.percentile_99_9 <= limits.percentile_99_9 &&
           difference.share_over_5 <= limits.share_over_5;
}

renderer::RenderedPicture as_picture(const PictureDifference& difference, int width) {
    renderer::RenderedPicture picture;
    picture.width = width;
    picture.height = static_cast<int>(difference.per_pixel.size()) / width;
    for (const float distance : difference.per_pixel) {
        const auto grey = static_cast<std::uint8_t>(25.5F * std::min(distance, 10.0F));
        picture.rgba.insert(picture.rgba.end(), {grey, grey, grey, 255});
    }
    return picture;
}

}  // namespace atrium::golden
