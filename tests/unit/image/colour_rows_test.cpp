#include "core/image/colour_rows.hpp"

#include "tests/support/skips.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace atrium::image {
namespace {

std::vector<std::uint8_t> random_bytes(std::size_t size, unsigned seed) {
    std::mt19937 random(seed);
    // clipped values are as likely as all others together
    std::uniform_int_distribution<int> byte(-128, 383);
    std::vector<std::uint8_t> bytes(size);
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(std::clamp(byte(random), 0, 255));
    return bytes;
}

struct Yuv {
    explicit Yuv(int width)
        : top(static_cast<std::size_t>(width), 7), bottom(top), u(top.size() / 2, 7), v(u) {}
    std::vector<std::uint8_t> top, bottom, u, v;
    bool operator==(const Yuv&) const = default;
};

Yuv packed(const std::vector<std::uint8_t>& bytes, int width, bool blue_first, RowCode code) {
    Yuv out(width);
    yuv_of_packed_rows({bytes.data(), bytes.data() + 3 * width, width, blue_first},
                       {out.top.data(), out.bottom.data(), out.u.data(), out.v.data()},
                       code);
    return out;
}

TEST(ColourRows, PackedRowsAreEqualWithAllInstructionSets) {
    if (best_row_code() == RowCode::kBaseline) GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    for (int width = 2; width < 240; width += 2) {
        const auto bytes =
            random_bytes(static_cast<std::size_t>(6 * width), static_cast<unsigned>(width));
        for (const bool blue_first : {true, false}) {
            EXPECT_EQ(packed(bytes, width, blue_first, RowCode::kBaseline),
                      packed(bytes, width, blue_first, RowCode::kAvx2))
                << width;
        }
    }
}

TEST(ColourRows, MosaicRowsAreEqualWithAllInstructionSets) {
    if (best_row_code() == RowCode::kBaseline) GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    for (int num_blocks = 1; num_blocks < 90; ++num_blocks) {
        const auto bytes = random_bytes(static_cast<std::size_t>(4 * num_blocks),
                                        static_cast<unsigned>(num_blocks));
        for (const int red_x : {0, 1}) {
            Yuv baseline(2 * num_blocks);
            Yuv avx2(2 * num_blocks);
            const MosaicRows rows{bytes.data(), bytes.data() + 2 * num_blocks, num_blocks, red_x};
            chroma_of_mosaic_rows(rows, baseline.u.data(), baseline.v.data(), RowCode::kBaseline);
            chroma_of_mosaic_rows(rows, avx2.u.data(), avx2.v.data(), RowCode::kAvx2);
            EXPECT_EQ(baseline, avx2) << num_blocks << ", red at " << red_x;
        }
    }
}

TEST(ColourRows, AreAccurateToSixTenthsOfAGreyLevel) {
    constexpr int kWidth = 200;
    const auto bytes = random_bytes(6 * kWidth, 1);
    const Yuv yuv = packed(bytes, kWidth, false, best_row_code());
    for (int x = 0; x < kWidth; ++x) {
        const std::uint8_t* rgb = bytes.data() + 3 * x;
        const double luma = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
        EXPECT_NEAR(yuv.top[static_cast<std::size_t>(x)], luma, 0.6);
        if (x % 2 != 0) continue;
        double r = 0, g = 0, b = 0;
        for (const int at : {3 * x, 3 * x + 3, 3 * (kWidth + x), 3 * (kWidth + x) + 3}) {
            const auto* pixel = bytes.data() + at;
            r += pixel[0] / 4.0, g += pixel[1] / 4.0, b += pixel[2] / 4.0;
        }
        const auto block = static_cast<std::size_t>(x / 2);
        EXPECT_NEAR(yuv.u[block], 128 - 0.168736 * r - 0.331264 * g + 0.5 * b, 0.52);
        EXPECT_NEAR(yuv.v[block], 128 + 0.5 * r - 0.418688 * g - 0.081312 * b, 0.52);
    }
}

// Every third value of each channel, including both ends, and every grey.
TEST(ColourRows, LumaFollowsTheMatrixAndIsExactForGrey) {
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < 256; ++i) {
        const auto level = static_cast<std::uint8_t>(i);
        rgb.insert(rgb.end(), {level, level, level});
    }
    for (int r = 0; r < 256; r += 3) {
        for (int g = 0; g < 256; g += 3) {
            for (int b = 0; b < 256; b += 3) {
                rgb.insert(rgb.end(),
                           {static_cast<std::uint8_t>(r),
                            static_cast<std::uint8_t>(g),
                            static_cast<std::uint8_t>(b)});
            }
        }
    }
    const auto width = static_cast<int>(rgb.size() / 3);
    ASSERT_EQ(width % 2, 0);
    Yuv out(width);
    yuv_of_packed_rows({rgb.data(), rgb.data(), width, false},
                       {out.top.data(), out.bottom.data(), out.u.data(), out.v.data()},
                       best_row_code());
    for (int i = 0; i < 256; ++i) EXPECT_EQ(out.top[static_cast<std::size_t>(i)], i);
    double worst = 0.0;
    for (std::size_t i = 0; i < out.top.size(); ++i) {
        const std::uint8_t* c = rgb.data() + 3 * i;
        worst =
            std::max(worst, std::abs(out.top[i] - (0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2])));
    }
    EXPECT_LT(worst, 0.6);
    EXPECT_EQ(out.top, out.bottom);
}

}  // namespace
}  // namespace atrium::image
