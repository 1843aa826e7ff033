#include "viewer/overlay/text_picture.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace atrium::viewer {
namespace {

constexpr std::size_t kMaxLength = 63;  // as names on the bus
constexpr int kHeight_px = 64;
constexpr int kBaseline_px = 46;  // from the top; 14 px remain for descenders
constexpr double kScale = 1.4;    // gives capitals of 30 px
constexpr int kMargin_px = 8;
constexpr int kStroke_px = 3;
constexpr int kRim_px = 11;

std::string printable(const std::string& text) {
    std::string kept = text.substr(0, kMaxLength);
    std::replace_if(
        kept.begin(), kept.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return kept;
}

}  // namespace

std::shared_ptr<const renderer::TexturePicture> draw_text(const std::string& text) {
    const std::string shown = printable(text);
    int below = 0;
    const cv::Size size =
        cv::getTextSize(shown, cv::FONT_HERSHEY_SIMPLEX, kScale, kStroke_px, &below);
    const cv::Size whole(size.width + 2 * kMargin_px, kHeight_px);
    cv::Mat letters(whole, CV_8UC1, cv::Scalar(0));
    cv::Mat rim(whole, CV_8UC1, cv::Scalar(0));
    const auto write = [&](cv::Mat& on, int thickness_px) {
        cv::putText(on,
                    shown,
                    {kMargin_px, kBaseline_px},
                    cv::FONT_HERSHEY_SIMPLEX,
                    kScale,
                    cv::Scalar(255),
                    thickness_px,
                    cv::LINE_AA);
    };
    write(letters, kStroke_px);
    write(rim, kRim_px);
    cv::GaussianBlur(rim, rim, {7, 7}, 0.0);
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
