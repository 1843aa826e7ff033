#include "site_node/texture/texture.hpp"

#include "tests/support/shapes/bounding_rect.hpp"
#include "tests/support/skips.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::texture {
namespace {

image::YuvImage noise_frame(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> byte(0, 255);
    image::YuvImage frame{image::Plane(width, height),
                          image::Plane(width / 2, height / 2),
                          image::Plane(width / 2, height / 2)};
    for (image::Plane* plane : {&frame.y, &frame.u, &frame.v}) {
        for (std::uint8_t& value : plane->data) value = static_cast<std::uint8_t>(byte(random));
    }
    return frame;
}

void fill(image::Plane& plane, const image::PixelRect& r, std::uint8_t value) {
    for (int y = r.y; y < r.y + r.height; ++y) std::fill_n(plane.row(y) + r.x, r.width, value);
}

TEST(CropTexture, IsEmptyForAnEmptySubject) {
    TextureScratch scratch;
    codec::TextureCrop crop;
    EXPECT_FALSE(crop_texture(noise_frame(64, 48, 1), image::Mask(64, 48), {}, {}, scratch, crop));
    EXPECT_TRUE(crop.crop_px.empty());
}

TEST(CropTexture, RectangleIsPaddedEvenAndInsideThePicture) {
    TextureScratch scratch;
    codec::TextureCrop crop;
    image::Mask mask(64, 48);
    fill(mask, {21, 13, 10, 9}, 255);
    ASSERT_TRUE(crop_texture(
        noise_frame(64, 48, 1), mask, test::bounding_rect(mask), {.padding_px = 4}, scratch, crop));
    EXPECT_EQ(crop.crop_px, (image::PixelRect{16, 8, 20, 18}));
    EXPECT_EQ(crop.width(), 10);
    EXPECT_EQ(crop.height(), 9);
    mask = image::Mask(64, 48, 255);
    ASSERT_TRUE(crop_texture(
        noise_frame(64, 48, 1), mask, test::bounding_rect(mask), {.padding_px = 4}, scratch, crop));
    EXPECT_EQ(crop.crop_px, (image::PixelRect{0, 0, 64, 48}));
}

TEST(CropTexture, ForegroundKeepsItsColoursAndTheMaskIsTheMajorityOfFour) {
    TextureScratch scratch;
    codec::TextureCrop crop;
    image::YuvImage frame = noise_frame(128, 96, 2);
    for (image::Plane* plane : {&frame.u, &frame.v}) {  // too grey for clean_outline_chroma
        for (std::uint8_t& value : plane->data) value = static_cast<std::uint8_t>(120 + value % 17);
    }
    std::mt19937 random(3);
    std::bernoulli_distribution on(0.6);
    image::Mask mask(128, 96);
    for (int y = 20; y < 80; ++y) {
        for (int x = 30; x < 110; ++x) mask.row(y)[x] = on(random) ? 255 : 0;
    }
    ASSERT_TRUE(crop_texture(frame, mask, test::bounding_rect(mask), {}, scratch, crop));
    int num_foreground = 0;
    for (int y = 0; y < crop.height(); ++y) {
        for (int x = 0; x < crop.width(); ++x) {
            const int fx = crop.crop_px.x + 2 * x;
            const int fy = crop.crop_px.y + 2 * y;
            int votes = 0;
            int luma = 0;
            for (const auto& [px, py] :
                 {std::pair{fx, fy}, {fx + 1, fy}, {fx, fy + 1}, {fx + 1, fy + 1}}) {
                if (mask.at(px, py) == 0) continue;
                ++votes;
                luma += frame.y.at(px, py);
            }
            ASSERT_EQ(crop.mask.at(x, y), votes >= 2 ? 255 : 0);
            if (votes < 2) continue;
            ++num_foreground;
            ASSERT_EQ(crop.y.at(x, y), (luma + votes / 2) / votes);
            ASSERT_EQ(crop.u.at(x, y), frame.u.at(fx / 2, fy / 2));
            ASSERT_EQ(crop.v.at(x, y), frame.v.at(fx / 2, fy / 2));
        }
    }
    EXPECT_GT(num_foreground, 500);
}

TEST(CropTexture, NoBackgroundColourIsLeft) {
    // subject: luma 100..120, chroma 90; background: 255 and 10
    image::YuvImage frame{
        image::Plane(200, 160, 255), image::Plane(100, 80, 10), image::Plane(100, 80, 10)};
    image::Mask mask(200, 160);
    for (int y = 0; y < 160; ++y) {
        for (int x = 0; x < 200; ++x) {
            if (std::hypot(x - 100, y - 80) > 55 && std::hypot(x - 180, y - 20) > 9) continue;
            mask.row(y)[x] = 255;
        }
    }
    for (int y = 0; y < 160; ++y) {
        for (int x = 0; x < 200; ++x) {
            // a pixel more than the mask, because a texel is the mean of four pixels
            const bool near =
                std::hypot(x - 100, y - 80) <= 58 || std::hypot(x - 180, y - 20) <= 12;
            if (!near) continue;
            frame.y.row(y)[x] = static_cast<std::uint8_t>(100 + x / 10);
            frame.u.row(y / 2)[x / 2] = frame.v.row(y / 2)[x / 2] = 90;
        }
    }
    TextureScratch scratch;
    codec::TextureCrop crop;
    ASSERT_TRUE(
        crop_texture(frame, mask, test::bounding_rect(mask), {.padding_px = 30}, scratch, crop));
    const auto [y_low, y_high] = std::minmax_element(crop.y.data.begin(), crop.y.data.end());
    EXPECT_GE(*y_low, 100);
    EXPECT_LE(*y_high, 120);
    EXPECT_EQ(std::count(crop.u.data.begin(), crop.u.data.end(), 90), std::ssize(crop.u.data));
    EXPECT_EQ(std::count(crop.v.data.begin(), crop.v.data.end(), 90), std::ssize(crop.v.data));
}

// A step at the edge costs bytes. If the subject is brighter from row to row, so must be its
// continuation.
TEST(CropTexture, ContinuesTheSubjectSmoothly) {
    image::YuvImage frame{
        image::Plane(32, 32, 255), image::Plane(16, 16, 128), image::Plane(16, 16, 128)};
    image::Mask mask(32, 32);
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 8; ++x) {
            mask.row(y)[x] = 255;
            frame.y.row(y)[x] = static_cast<std::uint8_t>(60 + 8 * (y / 2 % 8));
        }
    }
    TextureScratch scratch;
    codec::TextureCrop crop;
    ASSERT_TRUE(crop_texture(frame, mask, {0, 0, 32, 32}, {.padding_px = 0}, scratch, crop));
    ASSERT_EQ(crop.width(), 16);
    for (int y = 0; y < 16; ++y) {
        EXPECT_EQ(crop.y.at(3, y), 60 + 8 * (y % 8)) << "the subject itself";
        EXPECT_NEAR(crop.y.at(4, y), crop.y.at(3, y), 14) << y;
        if (y % 8 == 0) continue;
        EXPECT_GT(crop.y.at(4, y), crop.y.at(4, y - 1)) << y;
    }
    EXPECT_EQ(crop.y.at(12, 3), 88) << "no subject in this block: the mean";
}

// JPEG codes a block equal to the previous one with the fewest bits.
TEST(CropTexture, BlocksFarFromTheSubjectRepeatThePreviousOne) {
    const image::YuvImage frame = noise_frame(128, 64, 6);
    image::Mask mask(128, 64);
    fill(mask, {18, 18, 12, 12}, 255);
    fill(mask, {114, 34, 12, 12}, 255);
    TextureScratch scratch;
    codec::TextureCrop crop;
    ASSERT_TRUE(crop_texture(frame, mask, {0, 0, 128, 64}, {.padding_px = 0}, scratch, crop));
    ASSERT_EQ(crop.width(), 64);
    for (const image::Plane* plane : {&crop.y, &crop.u, &crop.v}) {
        for (int x = 24; x < 48; ++x) {
            for (int y = 0; y < 16; ++y) EXPECT_EQ(plane->at(x, y), plane->at(23, y / 8 * 8));
        }
    }
}

TEST(CropTexture, IsGreyIfTheForegroundVanishesAtHalfResolution) {
    image::Mask mask(32, 32);
    mask.row(9)[9] = 255;
    TextureScratch scratch;
    codec::TextureCrop crop;
    ASSERT_TRUE(
        crop_texture(noise_frame(32, 32, 4), mask, test::bounding_rect(mask), {}, scratch, crop));
    EXPECT_EQ(std::count(crop.mask.data.begin(), crop.mask.data.end(), 255), 0);
    EXPECT_EQ(std::count(crop.y.data.begin(), crop.y.data.end(), 128), std::ssize(crop.y.data));
}

TEST(CropTexture, OddMasksOfOddPicturesLoseTheirLastColumnAndRow) {
    image::Mask mask(33, 31);
    TextureScratch scratch;
    codec::TextureCrop crop;
    mask.row(30)[32] = 255;
    EXPECT_FALSE(crop_texture(
        noise_frame(32, 30, 5), mask, test::bounding_rect(mask), {.padding_px = 0}, scratch, crop));
    fill(mask, {20, 20, 13, 11}, 255);
    ASSERT_TRUE(
        crop_texture(noise_frame(32, 30, 5), mask, test::bounding_rect(mask), {}, scratch, crop));
    EXPECT_EQ(crop.crop_px, (image::PixelRect{16, 16, 16, 14}));
}

TEST(CropTexture, AtFullResolutionLumaAndMaskAreUnchanged) {
    TextureScratch scratch;
    codec::TextureCrop crop;
    image::YuvImage frame = noise_frame(128, 96, 6);
    fill(frame.u, {0, 0, 64, 48}, 70);
    image::Mask mask(128, 96);
    fill(mask, {31, 21, 50, 40}, 255);
    ASSERT_TRUE(crop_texture(
        frame, mask, test::bounding_rect(mask), {.resolution = Resolution::kFull}, scratch, crop));
    EXPECT_EQ(crop.crop_px, (image::PixelRect{26, 16, 60, 50}));
    ASSERT_EQ(crop.width(), 60);
    ASSERT_EQ(crop.height(), 50);
    for (int y = 0; y < crop.height(); ++y) {
        for (int x = 0; x < crop.width(); ++x) {
            const int fx = crop.crop_px.x + x;
            const int fy = crop.crop_px.y + y;
            ASSERT_EQ(crop.mask.at(x, y), mask.at(fx, fy));
            if (mask.at(fx, fy) == 0) continue;
            ASSERT_EQ(crop.y.at(x, y), frame.y.at(fx, fy));
            ASSERT_EQ(crop.u.at(x, y), 70);
        }
    }
}

// Chroma that rises evenly stays in place: no shift by half a pixel.
TEST(CropTexture, AtFullResolutionChromaStaysInPlace) {
    TextureScratch scratch;
    codec::TextureCrop crop;
    image::YuvImage frame = noise_frame(64, 64, 7);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) frame.v.row(y)[x] = static_cast<std::uint8_t>(4 * x + 2 * y);
    const image::Mask mask(64, 64, 255);
    ASSERT_TRUE(crop_texture(frame,
                             mask,
                             {10, 10, 40, 40},
                             {.padding_px = 0, .resolution = Resolution::kFull},
                             scratch,
                             crop));
    for (int y = 0; y < crop.height(); ++y)
        for (int x = 0; x < crop.width(); ++x)
            EXPECT_NEAR(crop.v.at(x, y),
                        4 * ((crop.crop_px.x + x + 0.5) / 2 - 0.5) +
                            2 * ((crop.crop_px.y + y + 0.5) / 2 - 0.5),
                        1.01);
}

// Every mosaic of one constant colour gives the colour's luma, up to the crop's edge.
TEST(CropTexture, AtFullResolutionMosaicsAreInterpolated) {
    TextureScratch scratch;
    codec::TextureCrop crop;
    for (const auto mosaic :
         {image::Mosaic::kRG, image::Mosaic::kGR, image::Mosaic::kGB, image::Mosaic::kBG}) {
        image::YuvImage frame = noise_frame(64, 64, 8);
        const image::RedAt red = image::red_at(mosaic);
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                const bool is_red = x % 2 == red.x && y % 2 == red.y;
                const bool is_blue = x % 2 != red.x && y % 2 != red.y;
                frame.y.row(y)[x] = is_red ? 200 : is_blue ? 40 : 100;
            }
        }
        image::YuvView view(frame);
        view.mosaic = mosaic;
        const image::Mask mask(64, 64, 255);
        for (const image::PixelRect& subject :
             {image::PixelRect{20, 20, 20, 20}, image::PixelRect{0, 0, 64, 64}}) {
            ASSERT_TRUE(crop_texture(
                view, mask, subject, {.resolution = Resolution::kFull}, scratch, crop));
            for (const std::uint8_t luma : crop.y.data) EXPECT_NEAR(luma, 123.1, 1.5);
        }
    }
}

TEST(CropTexture, StaysAtHalfIfTooLargeForFullResolution) {
    TextureScratch scratch;
    codec::TextureCrop crop;
    const image::Mask mask(1100, 1000, 255);
    ASSERT_TRUE(crop_texture(noise_frame(1100, 1000, 9),
                             mask,
                             test::bounding_rect(mask),
                             {.resolution = Resolution::kFull},
                             scratch,
                             crop));
    EXPECT_EQ(crop.width(), 550);
}

TEST(CropTexture, IsEqualForAllInstructionSets) {
    if (image::best_row_code() == image::RowCode::kBaseline)
        GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    std::mt19937 random(4);
    const auto number = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    TextureScratch scratch;
    for (int i = 0; i < 500; ++i) {
        const int width = number(2, 200);
        const int height = number(2, 40);
        const image::YuvImage frame =
            noise_frame(width & ~1, height & ~1, static_cast<unsigned>(i));
        image::YuvView view(frame);
        view.mosaic = static_cast<image::Mosaic>(i % 5);
        image::Mask mask(width, height);
        for (std::uint8_t& value : mask.data) value = number(0, 2) == 0 ? 255 : 0;
        const int x = number(0, width - 1);
        const int y = number(0, height - 1);
        const image::PixelRect subject{x, y, number(1, width - x), number(1, height - y)};
        const TextureOptions options{.padding_px = number(0, 5)};
        codec::TextureCrop plain, avx2;
        const bool some =
            crop_texture(view, mask, subject, options, scratch, plain, image::RowCode::kBaseline);
        ASSERT_EQ(crop_texture(view, mask, subject, options, scratch, avx2, image::RowCode::kAvx2),
                  some);
        EXPECT_EQ(plain.crop_px, avx2.crop_px);
        EXPECT_EQ(plain.y.data, avx2.y.data) << width << "x" << height << ", mosaic " << i % 5;
        EXPECT_EQ(plain.u.data, avx2.u.data);
        EXPECT_EQ(plain.v.data, avx2.v.data);
        EXPECT_EQ(plain.mask.data, avx2.mask.data);
    }
}

// A disc before a plain background. The chroma at its edge is the mean over the pixels.
class DiscBefore {
public:
    DiscBefore(int u, int v) : frame_(noise_frame(kSize, kSize, 5)), mask_(kSize, kSize) {
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) mask_.row(y)[x] = covers(x, y) ? 255 : 0;
        }
        for (int y = 0; y < kSize / 2; ++y) {
            for (int x = 0; x < kSize / 2; ++x) {
                const double share = share_of(x, y);
                frame_.u.row(y)[x] = mixed(kU, u, share);
                frame_.v.row(y)[x] = mixed(kV, v, share);
            }
        }
    }

    codec::TextureCrop crop(Resolution resolution) const {
        TextureScratch scratch;
        codec::TextureCrop out;
        EXPECT_TRUE(crop_texture(
            frame_, mask_, test::bounding_rect(mask_), {.resolution = resolution}, scratch, out));
        return out;
    }

    // Sum over the foreground of the distance of the chroma from the disc's.
    double error_of(const codec::TextureCrop& crop) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < crop.mask.data.size(); ++i) {
            if (crop.mask.data[i] != 0) sum += std::hypot(crop.u.data[i] - kU, crop.v.data[i] - kV);
        }
        return sum;
    }

    // The same for the picture.
    double error_of_picture(const codec::TextureCrop& crop) const {
        codec::TextureCrop plain = crop;
        for (int y = 0; y < crop.height(); ++y) {
            for (int x = 0; x < crop.width(); ++x) {
                plain.u.row(y)[x] = frame_.u.at(crop.crop_px.x / 2 + x, crop.crop_px.y / 2 + y);
                plain.v.row(y)[x] = frame_.v.at(crop.crop_px.x / 2 + x, crop.crop_px.y / 2 + y);
            }
        }
        return error_of(plain);
    }

private:
    static constexpr int kSize = 160;
    static constexpr int kU = 110;
    static constexpr int kV = 150;
    static bool covers(double x, double y) { return std::hypot(x - 80.3, y - 78.8) < 55.0; }
    static double share_of(int x, int y) {
        int num = 0;
        for (int dy = 0; dy < 16; ++dy) {
            for (int dx = 0; dx < 16; ++dx)
                num += covers(2 * x - 0.5 + (dx + 0.5) / 8, 2 * y - 0.5 + (dy + 0.5) / 8);
        }
        return num / 256.0;
    }
    static std::uint8_t mixed(int person, int background, double share) {
        return static_cast<std::uint8_t>(std::lround(share * person + (1.0 - share) * background));
    }

    image::YuvImage frame_;
    image::Mask mask_;
};

TEST(CropTexture, TheHueOfAColouredBackgroundLeavesTheOutline) {
    const DiscBefore green(90, 85);
    const codec::TextureCrop half = green.crop(Resolution::kHalf);
    EXPECT_GT(green.error_of_picture(half), 1000.0);
    EXPECT_LT(green.error_of(half), 0.5 * green.error_of_picture(half));
    // interpolated chroma also mixes further inside
    const codec::TextureCrop full = green.crop(Resolution::kFull);
    EXPECT_LT(green.error_of(full), 0.6 * 4.0 * green.error_of_picture(half));
}

TEST(CropTexture, ChromaBeforeAGreyBackgroundStaysAsItIs) {
    const DiscBefore grey(128, 128);
    const codec::TextureCrop half = grey.crop(Resolution::kHalf);
    EXPECT_EQ(grey.error_of(half), grey.error_of_picture(half));
}

}  // namespace
}  // namespace atrium::texture
