#include "site_node/segmentation/areas.hpp"
#include "site_node/segmentation_worker/alpha_mask.hpp"
#include "site_node/segmentation_worker/bgr_picture.hpp"
#include "tests/support/pictures/bgr_from_yuv.hpp"
#include "tests/support/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace atrium::segmentation_worker {
namespace {

image::YuvImage random_picture(int width, int height, test::Random& random) {
    image::YuvImage picture{image::Plane(width, height),
                            image::Plane(width / 2, height / 2),
                            image::Plane(width / 2, height / 2)};
    for (image::Plane* plane : {&picture.y, &picture.u, &picture.v})
        for (std::uint8_t& value : plane->data)
            value = static_cast<std::uint8_t>(test::between(random, 0, 255));
    return picture;
}

std::vector<std::uint8_t> bgr_of(const image::RawImage& raw) {
    image::YuvImage buffer;
    const image::YuvView view = image::working_view(raw, buffer);
    std::vector<std::uint8_t> out(3 * view.y.width * static_cast<std::size_t>(view.y.height));
    BgrPicture().write(raw, view, {}, out.data());
    return out;
}

TEST(BgrPicture, ConvertsEveryColourOfYuvAsTheReferenceDoes) {
    test::Random random(1);
    for (const auto& [width, height] : {std::pair{2, 2}, {66, 50}, {640, 34}, {130, 16}}) {
        const auto picture =
            std::make_shared<image::YuvImage>(random_picture(width, height, random));
        EXPECT_EQ(bgr_of(image::RawImage(picture)), test::bgr_from_yuv(*picture))
            << width << "x" << height;
    }
}

TEST(BgrPicture, CopiesBgrAsItIsWithoutAnOddLastColumnOrRow) {
    constexpr int kWidth = 37, kHeight = 21;
    constexpr std::size_t kStride = 3 * kWidth + 5;
    test::Random random(2);
    std::vector<std::uint8_t> bytes(kStride * kHeight);
    for (std::uint8_t& value : bytes)
        value = static_cast<std::uint8_t>(test::between(random, 0, 255));
    image::RawImage raw;
    raw.format = image::PixelFormat::kBgr;
    raw.width = kWidth;
    raw.height = kHeight;
    raw.planes[0] = {bytes.data(), kStride};
    const auto out = bgr_of(raw);
    ASSERT_EQ(out.size(), 3u * (kWidth - 1) * (kHeight - 1));
    for (std::size_t y = 0; y < kHeight - 1; ++y)
        for (std::size_t i = 0; i < 3 * (kWidth - 1); ++i)
            ASSERT_EQ(out[y * 3 * (kWidth - 1) + i], bytes[y * kStride + i]) << y << " " << i;
}

TEST(BgrPicture, KeepsTheColourOfPlainMosaicsOfEveryPattern) {
    constexpr int kSize = 32;
    constexpr std::array<std::uint8_t, 3> kBgr{40, 120, 200};
    for (const auto format : {image::PixelFormat::kBayerRG,
                              image::PixelFormat::kBayerGR,
                              image::PixelFormat::kBayerGB,
                              image::PixelFormat::kBayerBG}) {
        const image::RedAt red = image::red_at(image::mosaic_of(format));
        std::vector<std::uint8_t> samples(kSize * kSize, kBgr[1]);
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                const auto at = static_cast<std::size_t>(y * kSize + x);
                if (x % 2 == red.x && y % 2 == red.y) samples[at] = kBgr[2];
                if (x % 2 != red.x && y % 2 != red.y) samples[at] = kBgr[0];
            }
        }
        image::RawImage raw;
        raw.format = format;
        raw.width = raw.height = kSize;
        raw.planes[0] = {samples.data(), kSize};
        const auto out = bgr_of(raw);
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_EQ(out[i], kBgr[i % 3]) << static_cast<int>(format) << " at " << i;
    }
}

TEST(BgrPicture, ShowsTheLearnedRoomAndTheLightThatItFollowed) {
    test::Random random(3);
    const image::YuvImage room = random_picture(64, 48, random);
    segmentation::BackgroundLearner learner;
    ASSERT_TRUE(learner.add(room));
    auto model = learner.finish(segmentation::SegmentationOptions{}).value();
    std::vector<std::uint8_t> out(3 * 64 * 48);
    BgrPicture bgr;
    bgr.write(model, {}, out.data());
    EXPECT_EQ(out, test::bgr_from_yuv(room));

    for (std::uint16_t& luma : model.luma) luma = 100 * 256;
    std::ranges::fill(model.u, std::int16_t{0});
    std::ranges::fill(model.v, std::int16_t{0});
    bgr.write(model, {}, out.data());
    EXPECT_THAT(out, testing::Each(100));
}

constexpr int kWidth = 64, kHeight = 40;

struct Alpha {
    std::vector<std::uint8_t> values = std::vector<std::uint8_t>(kWidth * kHeight);

    void fill(const image::PixelRect& part, std::uint8_t value) {
        for (int y = part.y; y < part.y + part.height; ++y)
            std::fill_n(values.begin() + y * kWidth + part.x, part.width, value);
    }
    image::Mask mask(const image::Mask& areas = {}) const {
        image::SparseMask out;
        out.mask = image::Mask(kWidth, kHeight, 255);  // of a former picture
        segmentation::CleanScratch scratch;
        mask_of_alpha(
            values.data(), areas, {.min_area_px = 20, .max_hole_px = 20}, {}, scratch, out);
        return out.mask;
    }
};

TEST(AlphaMask, TakesPixelsFrom128On) {
    Alpha alpha;
    alpha.fill({0, 0, kWidth / 2, kHeight}, 127);
    alpha.fill({kWidth / 2, 0, kWidth / 2, kHeight}, 128);
    const image::Mask mask = alpha.mask();
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            ASSERT_EQ(mask.at(x, y), x < kWidth / 2 ? 0 : 255) << x << " " << y;
}

TEST(AlphaMask, RemovesSpecksAndFillsHolesAsTheBuiltInSegmentationDoes) {
    Alpha alpha;
    alpha.fill({10, 10, 20, 20}, 255);
    alpha.fill({15, 15, 4, 4}, 0);   // a hole of 16 px
    alpha.fill({50, 5, 4, 4}, 255);  // a speck of 16 px
    const image::Mask mask = alpha.mask();
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            ASSERT_EQ(mask.at(x, y), x >= 10 && x < 30 && y >= 10 && y < 30 ? 255 : 0)
                << x << " " << y;
}

TEST(AlphaMask, IsBackgroundOutsideTheAreas) {
    Alpha alpha;
    alpha.fill({0, 0, kWidth, kHeight}, 255);
    const segmentation::SegmentationAreas areas{
        .include = {{{0, 0}, {31.5, 0}, {31.5, 39}, {0, 39}}}, .exclude = {}};
    const image::Mask area = segmentation::rasterise(areas, kWidth, kHeight);
    EXPECT_EQ(alpha.mask(area).data, area.data);
}

}  // namespace
}  // namespace atrium::segmentation_worker
