#include "core/codec/picture_encoder.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <vector>

namespace atrium::codec {
namespace {

std::vector<std::uint8_t> ramp(int width, int height) {
    std::vector<std::uint8_t> rgba;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int value : {40 + 3 * x, 200 - 2 * y, 90, x})
                rgba.push_back(static_cast<std::uint8_t>(value));
    return rgba;
}

TEST(PictureEncoder, KeepsColoursAndRowOrder) {
    PictureEncoder encoder;
    // several sizes, because the encoder reuses its growing memory
    for (const auto& [width, height] : {std::pair(16, 8), {61, 47}, {64, 48}, {17, 9}}) {
        SCOPED_TRACE(testing::Message() << width << " x " << height);
        const auto jpeg = encoder.encode(ramp(width, height), width, height, 95);
        ASSERT_TRUE(jpeg) << jpeg.error().message;
        const cv::Mat bgr = cv::imdecode(
            cv::Mat(
                1, static_cast<int>(jpeg->size()), CV_8U, const_cast<std::uint8_t*>(jpeg->data())),
            cv::IMREAD_COLOR);
        ASSERT_EQ(bgr.size(), cv::Size(width, height));
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const auto& pixel = bgr.at<cv::Vec3b>(y, x);
                ASSERT_NEAR(pixel[2], 40 + 3 * x, 10) << x << ", " << y;
                ASSERT_NEAR(pixel[1], 200 - 2 * y, 10) << x << ", " << y;
                ASSERT_NEAR(pixel[0], 90, 10) << x << ", " << y;
            }
        }
    }
}

TEST(PictureEncoder, RefusesBadPictures) {
    PictureEncoder encoder;
    const std::vector<std::uint8_t> rgba = ramp(16, 8);
    for (const auto& [width, height] :
         {std::pair(16, 9), {15, 8}, {0, 0}, {-16, -8}, {16, 0}, {8, 8}}) {
        const auto jpeg = encoder.encode(rgba, width, height, 80);
        ASSERT_FALSE(jpeg) << width << " x " << height;
        EXPECT_EQ(jpeg.error().kind, ErrorKind::kInvalidData);
    }
    EXPECT_FALSE(encoder.encode(ramp(70'000, 1), 70'000, 1, 80));  // wider than JPEG allows
    EXPECT_TRUE(encoder.encode(rgba, 16, 8, 80));
}

}  // namespace
}  // namespace atrium::codec
