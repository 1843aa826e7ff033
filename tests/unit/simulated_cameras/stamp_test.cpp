#include "tools/simulated_cameras/stamp.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace atrium::simulated_cameras {
namespace {

using image::PixelFormat;

constexpr int kWidth = 200;
constexpr int kHeight = 80;

image::RawImage picture_over(const std::vector<std::uint8_t>& bytes, PixelFormat format) {
    image::RawImage picture;
    picture.format = format;
    picture.width = kWidth;
    picture.height = kHeight;
    picture.planes[0] = {bytes.data(), image::row_bytes(format, kWidth)};
    return picture;
}

std::vector<std::uint8_t> random_bytes(std::size_t num, unsigned seed) {
    std::mt19937 engine(seed);
    std::vector<std::uint8_t> bytes(num);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(engine());
    return bytes;
}

TEST(Stamp, IsReadableInEveryCameraFormat) {
    for (const PixelFormat format : {PixelFormat::kMono8,
                                     PixelFormat::kBayerRG,
                                     PixelFormat::kBayerGR,
                                     PixelFormat::kBayerGB,
                                     PixelFormat::kBayerBG,
                                     PixelFormat::kRgb}) {
        for (const Stamp stamp : {Stamp{0, 0}, Stamp{7, 123456}, Stamp{255, 0xffffffffu}}) {
            auto bytes = random_bytes(image::row_bytes(format, kWidth) * kHeight, 1);
            write_stamp(stamp, format == PixelFormat::kRgb ? 3 : 1, kWidth, kHeight, bytes.data());
            const auto read = read_stamp(picture_over(bytes, format));
            ASSERT_TRUE(read);
            EXPECT_EQ(*read, stamp);
        }
    }
}

TEST(Stamp, SurvivesNoise) {
    auto bytes = random_bytes(kWidth * kHeight, 2);
    write_stamp({3, 99}, 1, kWidth, kHeight, bytes.data());
    std::mt19937 engine(3);
    std::normal_distribution<double> noise(0.0, 30.0);
    for (auto& byte : bytes)
        byte = static_cast<std::uint8_t>(std::clamp(byte + noise(engine), 0.0, 255.0));
    EXPECT_EQ(read_stamp(picture_over(bytes, PixelFormat::kMono8)), (Stamp{3, 99}));
}

TEST(Stamp, IsNotFoundWithoutAStamp) {
    for (unsigned seed = 0; seed < 100; ++seed) {
        EXPECT_FALSE(
            read_stamp(picture_over(random_bytes(kWidth * kHeight, seed), PixelFormat::kMono8)));
    }
    const std::vector<std::uint8_t> black(kWidth * kHeight, 0);
    EXPECT_FALSE(read_stamp(picture_over(black, PixelFormat::kMono8)));
    EXPECT_FALSE(read_stamp({}));
}

TEST(Stamp, IsNotFoundInAMixtureOfTwoPictures) {
    // a striped picture: the first rows of one picture, the rest of another
    std::vector<std::uint8_t> old_bytes(kWidth * kHeight), new_bytes(kWidth * kHeight);
    write_stamp({1, 41}, 1, kWidth, kHeight, old_bytes.data());
    write_stamp({1, 42}, 1, kWidth, kHeight, new_bytes.data());
    ASSERT_TRUE(read_stamp(picture_over(old_bytes, PixelFormat::kMono8)));
    for (int rows = kStampHeightPx; rows <= kHeight - kStampHeightPx; ++rows) {
        auto mixed = old_bytes;
        std::copy_n(new_bytes.begin(), rows * kWidth, mixed.begin());
        EXPECT_FALSE(read_stamp(picture_over(mixed, PixelFormat::kMono8))) << rows;
    }
}

TEST(Stamp, DoesNotChangeAPictureThatIsTooSmall) {
    std::vector<std::uint8_t> bytes(64 * 64, 7);
    write_stamp({1, 2}, 1, 64, 64, bytes.data());
    EXPECT_EQ(bytes, std::vector<std::uint8_t>(64 * 64, 7));
}

}  // namespace
}  // namespace atrium::simulated_cameras
