#include "tools/simulated_cameras/sensor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

namespace atrium::simulated_cameras {
namespace {

using image::PixelFormat;

constexpr int kSide = 16;

// A picture of one colour, as the site sees it.
image::YuvImage uniform(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
    std::vector<std::uint8_t> bgr;
    for (int i = 0; i < kSide * kSide; ++i) bgr.insert(bgr.end(), {blue, green, red});
    image::YuvImage picture;
    image::yuv_from_bgr(bgr.data(), kSide, kSide, 3 * kSide, picture);
    return picture;
}

TEST(Sensor, EachPixelHasTheColourOfItsFilter) {
    const std::array<int, 3> colour{200, 120, 40};
    const image::YuvImage picture = uniform(200, 120, 40);
    // red 0, green 1, blue 2 of the first 2x2 block
    const std::array<std::pair<PixelFormat, std::array<std::size_t, 4>>, 4> mosaics{
        {{PixelFormat::kBayerRG, {0, 1, 1, 2}},
         {PixelFormat::kBayerGR, {1, 0, 2, 1}},
         {PixelFormat::kBayerGB, {1, 2, 0, 1}},
         {PixelFormat::kBayerBG, {2, 1, 1, 0}}}};
    for (const auto& [format, filters] : mosaics) {
        const std::vector<std::uint8_t> bytes = sense(picture, format);
        ASSERT_EQ(bytes.size(), static_cast<std::size_t>(kSide * kSide));
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                const std::size_t filter = filters[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
                EXPECT_NEAR(bytes[static_cast<std::size_t>(y * kSide + x)], colour[filter], 2);
            }
        }
    }
}

TEST(Sensor, DeliversWhatTheSiteDecodes) {
    const image::YuvImage picture = uniform(90, 150, 210);
    for (const std::string& name : pixel_format_names()) {
        const PixelFormat format = *find_pixel_format(name);
        const std::vector<std::uint8_t> bytes = sense(picture, format);
        image::RawImage raw;
        raw.format = format;
        raw.width = raw.height = kSide;
        raw.planes[0] = {bytes.data(), image::row_bytes(format, kSide)};
        image::YuvImage buffer;
        const image::YuvView seen = image::working_view(raw, buffer);
        const bool has_colour = format != PixelFormat::kMono8;
        EXPECT_NEAR(seen.u.at(3, 3), has_colour ? picture.u.at(3, 3) : 128, 3) << name;
        EXPECT_NEAR(seen.v.at(3, 3), has_colour ? picture.v.at(3, 3) : 128, 3) << name;
        if (seen.mosaic == image::Mosaic::kNone) {
            EXPECT_NEAR(seen.y.at(3, 3), picture.y.at(3, 3), 2) << name;
        }
    }
}

TEST(Sensor, RefusesUnsupportedFormats) {
    const auto format = find_pixel_format("YUV422");
    ASSERT_FALSE(format);
    EXPECT_EQ(format.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(format.error().message,
                testing::AllOf(testing::HasSubstr("YUV422"), testing::HasSubstr("BayerRG8")));
}

}  // namespace
}  // namespace atrium::simulated_cameras
