#include "viewer/overlay/text_picture.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::viewer {
namespace {

constexpr std::size_t kMaxLength = 63;  // as names on the bus
// for a picture of kTextHeight_px
constexpr double kBaseline_px = 46.0;  // from the top; 14 px remain for descenders
constexpr double kScale = 1.4;         // gives capitals of 30 px
constexpr double kMargin_px = 8.0;
constexpr double kStroke_px = 3.0;
constexpr double kRim_px = 11.0;
constexpr double kBlur_px = 7.0;
constexpr int kMinHeight_px = 16;
constexpr int kMaxHeight_px = 256;

std::string printable(const std::string& text) {
    std::string kept = text.substr(0, kMaxLength);
    std::replace_if(
        kept.begin(), kept.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return kept;
}

}  // namespace

int text_height_px(double share, int picture_height_px) {
    const int height_px = static_cast<int>(std::lround(share * picture_height_px));
    return std::clamp(height_px, kMinHeight_px, kMaxHeight_px);
}

std::shared_ptr<const renderer::TexturePicture> draw_text(const std::string& text, int height_px) {
    assert(height_px >= kMinHeight_px && height_px <= kMaxHeight_px);
    const std::string shown = printable(text);
    const double size_share = static_cast<double>(height_px) / kTextHeight_px;
    const auto px = [&](double at_64_px) {
        return std::max(1, static_cast<int>(std::lround(size_share * at_64_px)));
    };
    const double scale = size_share * kScale;
    int below = 0;
    const cv::Size size =
        cv::getTextSize(shown, cv::FONT_HERSHEY_SIMPLEX, scale, px(kStroke_px), &below);
    const cv::Size whole(size.width + 2 * px(kMargin_px), height_px);
    cv::Mat letters(whole, CV_8UC1, cv::Scalar(0));
    cv::Mat rim(whole, CV_8UC1, cv::Scalar(0));
    const auto write = [&](cv::Mat& on, int thickness_px) {
        cv::putText(on,
                    shown,
                    {px(kMargin_px), px(kBaseline_px)},
                    cv::FONT_HERSHEY_SIMPLEX,
                    scale,
                    cv::Scalar(255),
                    thickness_px,
                    cv::LINE_AA);
    };
    write(letters, px(kStroke_px));
    write(rim, px(kRim_px));
    const int blur_px = px(kBlur_px) / 2 * 2 + 1;  // an odd size
    cv::GaussianBlur(rim, rim, {blur_px, blur_px}, 0.0);
    auto picture = std::make_shared<renderer::TexturePicture>();
    picture->width = whole.width;
    picture->height = whole.height;
    picture->rgba.reserve(std::size_t{4} * letters.total());
    for (int y = 0; y < whole.height; ++y) {
        for (int x = 0; x < whole.width; ++x) {
            const std::uint8_t white = letters.at<std::uint8_t>(y, x);
            const auto dark = static_cast<std::uint8_t>(rim.at<std::uint8_t>(y, x) * 3 / 4);
            picture->rgba.insert(picture->rgba.end(), {white, white, white, std::max(white, dark)});
        }
    }
    return picture;
}

}  // namespace atrium::viewer
