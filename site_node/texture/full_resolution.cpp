#include "site_node/texture/full_resolution.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstddef>

namespace atrium::texture {
namespace {

cv::Mat view_of(const image::PlaneView& plane, const image::PixelRect& part) {
    auto* first = const_cast<std::uint8_t*>(plane.row(part.y) + part.x);
    return {part.height, part.width, CV_8UC1, first, static_cast<std::size_t>(plane.stride_bytes)};
}

cv::Mat view_of(image::Plane& plane) {
    return {plane.height, plane.width, CV_8UC1, plane.data.data()};
}

// Returns `rect` widened by `margin` on each side, within the picture.
image::PixelRect widened(const image::PixelRect& rect, int margin, int width, int height) {
    const int x0 = std::max(rect.x - margin, 0);
    const int y0 = std::max(rect.y - margin, 0);
    const int x1 = std::min(rect.x + rect.width + margin, width);
    const int y1 = std::min(rect.y + rect.height + margin, height);
    return {x0, y0, x1 - x0, y1 - y0};
}

// Copies the part of `wide`, a picture of `wide_rect`, that shows `rect` to `out`.
void cut(const cv::Mat& wide,
         const image::PixelRect& wide_rect,
         const image::PixelRect& rect,
         image::Plane& out) {
    cv::Mat to = view_of(out);
    wide(cv::Rect(rect.x - wide_rect.x, rect.y - wide_rect.y, rect.width, rect.height)).copyTo(to);
}

int conversion_of(image::Mosaic mosaic) {
    switch (mosaic) {
        case image::Mosaic::kRG:
            return cv::COLOR_BayerRGGB2GRAY;
        case image::Mosaic::kGR:
            return cv::COLOR_BayerGRBG2GRAY;
        case image::Mosaic::kGB:
            return cv::COLOR_BayerGBRG2GRAY;
        case image::Mosaic::kBG:
        case image::Mosaic::kNone:
            break;
    }
    return cv::COLOR_BayerBGGR2GRAY;
}

}  // namespace

void full_luma(const image::YuvView& frame, const image::PixelRect& crop, image::Plane& out) {
    if (frame.mosaic == image::Mosaic::kNone) {
        cv::Mat to = view_of(out);
        view_of(frame.y, crop).copyTo(to);
        return;
    }
    // even, to keep the first pixel of the mosaic at its colour
    constexpr int kMargin = 2;
    const image::PixelRect wide = widened(crop, kMargin, frame.width(), frame.height());
    cv::Mat luma;
    cv::cvtColor(view_of(frame.y, wide), luma, conversion_of(frame.mosaic));
    cut(luma, wide, crop, out);
}

void full_chroma(const image::PlaneView& chroma, const image::PixelRect& crop, image::Plane& out) {
    const image::PixelRect half{crop.x / 2, crop.y / 2, crop.width / 2, crop.height / 2};
    const image::PixelRect wide = widened(half, 1, chroma.width, chroma.height);
    cv::Mat doubled;
    cv::resize(
        view_of(chroma, wide), doubled, {2 * wide.width, 2 * wide.height}, 0, 0, cv::INTER_LINEAR);
    cut(doubled, {2 * wide.x, 2 * wide.y, 2 * wide.width, 2 * wide.height}, crop, out);
}

}  // namespace atrium::texture
