#include "tests/support/pictures/texture_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace atrium::test {
namespace {

/// A grey crop whose upper half is foreground.
codec::TextureCrop grey_crop(std::uint8_t level) {
    codec::TextureCrop crop;
    crop.y = image::Plane(16, 8, level);
    crop.u = crop.v = image::Plane(16, 8, 128);
    crop.mask = image::Mask(16, 8);
    for (int y = 0; y < 4; ++y) std::fill_n(crop.mask.row(y), 16, 255);
    return crop;
}

codec::DecodedTexture shown(int red, int green, int blue) {
    codec::DecodedTexture texture{16, 8, {}};
    for (int i = 0; i < 16 * 8; ++i) {
        for (const int value : {red, green, blue, i < 16 * 4 ? 255 : 0})
            texture.rgba.push_back(static_cast<std::uint8_t>(value));
    }
    return texture;
}

double psnr_of(double mean_square) { return 10.0 * std::log10(255.0 * 255.0 / mean_square); }

TEST(SampleError, IsTheRatioOfPeakToMeanSquare) {
    SampleError error;
    EXPECT_TRUE(std::isinf(error.psnr_db()));
    error.add(10.0, 10.0);
    EXPECT_TRUE(std::isinf(error.psnr_db()));
    error.add(10.0, 12.0);  // 4 over two samples
    EXPECT_NEAR(error.psnr_db(), psnr_of(2.0), 1e-9);
    EXPECT_NEAR(error.psnr_db(), 45.1205, 1e-4);
    SampleError worst;
    worst.add(0.0, 255.0);
    EXPECT_NEAR(worst.psnr_db(), 0.0, 1e-12);
    worst.add(error);  // 4 + 255^2 over three
    EXPECT_NEAR(worst.psnr_db(), psnr_of((4.0 + 255.0 * 255.0) / 3.0), 1e-9);
    EXPECT_EQ(worst.num_samples(), 3U);
}

TEST(TextureError, OfABrighterGreyIsEqualInRgbAndLuma) {
    const TextureError error = texture_error(grey_crop(100), shown(103, 103, 103));
    EXPECT_NEAR(error.rgb.psnr_db(), psnr_of(9.0), 1e-9);
    EXPECT_NEAR(error.luma.psnr_db(), psnr_of(9.0), 1e-9);
    EXPECT_GT(error.chroma.psnr_db(), 200.0);
    EXPECT_EQ(error.luma.num_samples(), 64U);
    EXPECT_EQ(error.rgb.num_samples(), 3U * 64U);
}

TEST(TextureError, SplitsAColourErrorIntoLumaAndChromaByWeight) {
    const TextureError error = texture_error(grey_crop(100), shown(100, 100, 110));  // bluer by 10
    EXPECT_NEAR(error.rgb.psnr_db(), psnr_of(100.0 / 3.0), 1e-9);
    EXPECT_NEAR(error.luma.psnr_db(), psnr_of(1.14 * 1.14), 1e-9);
    const double blue = (10.0 - 1.14) / 1.772;
    const double red = -1.14 / 1.402;
    EXPECT_NEAR(error.chroma.psnr_db(), psnr_of((blue * blue + red * red) / 2.0), 1e-9);
    EXPECT_NEAR(
        error.ycbcr().psnr_db(), psnr_of((1.14 * 1.14 + blue * blue + red * red) / 3.0), 1e-9);
}

TEST(TextureError, IgnoresPixelsOutsideTheSubject) {
    codec::TextureCrop crop = grey_crop(100);
    for (int y = 4; y < 8; ++y) std::fill_n(crop.y.row(y), 16, 200);
    EXPECT_TRUE(std::isinf(texture_error(crop, shown(100, 100, 100)).rgb.psnr_db()));
}

TEST(TextureError, ClampsColoursThatNoScreenCanShow) {
    codec::TextureCrop crop = grey_crop(250);
    std::fill(crop.v.data.begin(), crop.v.data.end(), 200);  // red would be 351
    const TextureError error = texture_error(crop, shown(255, 199, 250));
    EXPECT_GT(error.rgb.psnr_db(), 50.0);
}

}  // namespace
}  // namespace atrium::test
