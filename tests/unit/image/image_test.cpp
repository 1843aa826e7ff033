#include "core/image/image.hpp"

#include "tests/support/pictures/bgr_from_yuv.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

namespace atrium::image {
namespace {

using Bgr = std::array<std::uint8_t, 3>;

std::vector<std::uint8_t> plain(Bgr colour, int width, int height) {
    std::vector<std::uint8_t> bgr;
    for (int i = 0; i < width * height; ++i) bgr.insert(bgr.end(), colour.begin(), colour.end());
    return bgr;
}

TEST(YuvImage, KnownColoursHaveTheirFullRangeBt601Values) {
    struct Case {
        Bgr bgr;
        std::array<int, 3> yuv;
    };
    for (const Case& c : {Case{{0, 0, 0}, {0, 128, 128}},
                          Case{{255, 255, 255}, {255, 128, 128}},
                          Case{{0, 0, 255}, {76, 85, 255}},
                          Case{{0, 255, 0}, {150, 44, 21}},
                          Case{{255, 0, 0}, {29, 255, 107}}}) {
        YuvImage image;
        yuv_from_bgr(plain(c.bgr, 4, 2).data(), 4, 2, 12, image);
        EXPECT_NEAR(image.y.at(1, 1), c.yuv[0], 1);
        EXPECT_NEAR(image.u.at(1, 0), c.yuv[1], 1);
        EXPECT_NEAR(image.v.at(1, 0), c.yuv[2], 1);
    }
}

TEST(YuvImage, RoundTripOfPlainColoursIsWithinTwoLevels) {
    std::mt19937 random(1);
    std::uniform_int_distribution<int> byte(0, 255);
    YuvImage image;
    for (int i = 0; i < 300; ++i) {
        const Bgr colour = {static_cast<std::uint8_t>(byte(random)),
                            static_cast<std::uint8_t>(byte(random)),
                            static_cast<std::uint8_t>(byte(random))};
        yuv_from_bgr(plain(colour, 6, 4).data(), 6, 4, 18, image);
        const std::vector<std::uint8_t> back = test::bgr_from_yuv(image);
        for (std::size_t k = 0; k < back.size(); ++k)
            EXPECT_LE(std::abs(back[k] - colour[k % 3]), 2);
    }
}

TEST(YuvImage, ChromaIsTheMeanOfItsBlock) {
    std::vector<std::uint8_t> bgr = plain({0, 0, 0}, 2, 2);
    bgr[0] = 200;  // one of four pixels is blue
    YuvImage image;
    yuv_from_bgr(bgr.data(), 2, 2, 6, image);
    EXPECT_NEAR(image.u.at(0, 0), 128 + 0.5 * 200 / 4, 1);
    EXPECT_EQ(image.y.at(1, 1), 0);
}

TEST(YuvImage, OddSizesLoseTheirLastColumnAndRow) {
    // rows of 7 pixels, of which 5 belong to the picture
    std::vector<std::uint8_t> bgr = plain({255, 255, 255}, 7, 3);
    for (int y = 0; y < 3; ++y) std::fill_n(bgr.begin() + y * 21, 15, 50 * y);
    YuvImage image;
    yuv_from_bgr(bgr.data(), 5, 3, 21, image);
    EXPECT_EQ(image.width(), 4);
    EXPECT_EQ(image.height(), 2);
    EXPECT_EQ(image.u.width, 2);
    EXPECT_EQ(image.v.height, 1);
    for (int x = 0; x < 4; ++x) {
        EXPECT_EQ(image.y.at(x, 0), 0);
        EXPECT_EQ(image.y.at(x, 1), 50);
    }
}

}  // namespace
}  // namespace atrium::image
