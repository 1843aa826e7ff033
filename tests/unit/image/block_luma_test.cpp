#include "core/image/block_luma.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace atrium::image {
namespace {

constexpr int kBlockedWidth = 150;
constexpr int kBlockedHeight = 4;

Plane random_plane(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> byte(0, 255);
    Plane plane(kBlockedWidth, kBlockedHeight);
    for (std::uint8_t& value : plane.data) value = static_cast<std::uint8_t>(byte(random));
    return plane;
}

// Computes block luma from the colours of the block's samples, row by row.
double expected_luma(const Plane& plane, Mosaic mosaic, int x, int y) {
    constexpr std::array<const char*, 5> kColours{"", "RGGB", "GRBG", "GBRG", "BGGR"};
    double luma = 0.0;
    for (int i = 0; i < 4; ++i) {
        const double sample = plane.at(x + i % 2, y + i / 2);
        if (mosaic == Mosaic::kNone) {
            luma += sample / 4.0;
            continue;
        }
        const char colour = kColours[static_cast<std::size_t>(mosaic)][i];
        luma += sample * (colour == 'R' ? 0.299 : colour == 'B' ? 0.114 : 0.587 / 2.0);
    }
    return luma;
}

TEST(BlockLuma, MatchesTheBlocksColourWithAllInstructionSets) {
    const Plane plane = random_plane(1);
    for (const Mosaic mosaic :
         {Mosaic::kNone, Mosaic::kRG, Mosaic::kGR, Mosaic::kGB, Mosaic::kBG}) {
        YuvView picture;
        picture.y = plane;
        picture.mosaic = mosaic;
        for (int num_blocks = 0; num_blocks <= kBlockedWidth / 2 - 2; ++num_blocks) {
            const BlockRow blocks{4, 2, num_blocks};
            const auto size = static_cast<std::size_t>(num_blocks);
            std::vector<std::uint8_t> baseline(size + 1, 7);
            luma_of_blocks(picture, blocks, RowCode::kBaseline, baseline.data());
            for (std::size_t i = 0; i < size; ++i) {
                const int x = blocks.x + 2 * static_cast<int>(i);
                EXPECT_NEAR(baseline[i], expected_luma(plane, mosaic, x, blocks.y), 0.52);
            }
            EXPECT_EQ(baseline[size], 7);  // nothing is written past the end
            if (best_row_code() == RowCode::kBaseline) continue;
            std::vector<std::uint8_t> avx2(size + 1, 7);
            luma_of_blocks(picture, blocks, RowCode::kAvx2, avx2.data());
            EXPECT_EQ(avx2, baseline);
        }
    }
}

}  // namespace
}  // namespace atrium::image
