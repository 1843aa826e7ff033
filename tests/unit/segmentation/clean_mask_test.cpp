#include "site_node/segmentation/clean_mask.hpp"

#include "tests/support/shapes/whole_mask.hpp"
#include "tests/support/skips.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace atrium::segmentation {
namespace {

image::Mask noise(int width, int height, double density, unsigned seed) {
    std::mt19937 random(seed);
    std::bernoulli_distribution on(density);
    image::Mask mask(width, height);
    for (std::uint8_t& value : mask.data) value = on(random) ? 255 : 0;
    return mask;
}

// Reference by flood fill, component by component.
image::Mask without_small_parts(const image::Mask& in, int min_area_px, int max_hole_px) {
    image::Mask out = in;
    std::vector<bool> seen(in.data.size());
    for (int start = 0; start < static_cast<int>(in.data.size()); ++start) {
        if (seen[static_cast<std::size_t>(start)]) continue;
        const std::uint8_t value = in.data[static_cast<std::size_t>(start)];
        std::vector<int> part;
        std::vector<int> open{start};
        while (!open.empty()) {
            const int i = open.back();
            open.pop_back();
            if (seen[static_cast<std::size_t>(i)]) continue;
            seen[static_cast<std::size_t>(i)] = true;
            part.push_back(i);
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    if (value != 0 && dx != 0 && dy != 0) continue;
                    const int x = i % in.width + dx;
                    const int y = i / in.width + dy;
                    if (x < 0 || y < 0 || x >= in.width || y >= in.height || in.at(x, y) != value)
                        continue;
                    open.push_back(y * in.width + x);
                }
            }
        }
        if (static_cast<int>(part.size()) >= (value != 0 ? min_area_px : max_hole_px)) continue;
        for (const int i : part)
            out.data[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(~value);
    }
    return out;
}

TEST(CleanMask, MajorityCountsNinePixelsWithRepeatedBorders) {
    CleanScratch scratch;
    image::Mask out;
    for (unsigned seed = 0; seed < 8; ++seed) {
        const image::Mask in = noise(37 - static_cast<int>(seed) * 4, 19, 0.5, seed);
        test::majority_3x3(in, scratch, out);
        for (int y = 0; y < in.height; ++y) {
            for (int x = 0; x < in.width; ++x) {
                int votes = 0;
                for (int dy = -1; dy <= 1; ++dy) {
                    for (int dx = -1; dx <= 1; ++dx) {
                        votes += in.at(std::clamp(x + dx, 0, in.width - 1),
                                       std::clamp(y + dy, 0, in.height - 1)) != 0;
                    }
                }
                ASSERT_EQ(out.at(x, y), votes >= 5 ? 255 : 0) << x << ", " << y;
            }
        }
    }
}

TEST(CleanMask, MajorityIsEqualForAllInstructionSets) {
    if (best_instruction_set() == InstructionSet::kBaseline)
        GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    CleanScratch scratch;
    for (unsigned seed = 0; seed < 60; ++seed) {
        const int width = 1 + 3 * static_cast<int>(seed);
        const image::Mask rows = noise(width, 3, seed % 7 == 0 ? 0.02 : 0.5, seed);
        std::vector<std::uint8_t> baseline(static_cast<std::size_t>(width), 1);
        std::vector<std::uint8_t> avx2(static_cast<std::size_t>(width), 2);
        const ThreeRows three{rows.row(0), rows.row(1), rows.row(2), width};
        majority_3x3(three, InstructionSet::kBaseline, scratch, baseline.data());
        majority_3x3(three, InstructionSet::kAvx2, scratch, avx2.data());
        EXPECT_EQ(baseline, avx2) << width;
    }
}

TEST(CleanMask, RemovesSmallPartsLikeFloodFill) {
    CleanScratch scratch;
    for (unsigned seed = 0; seed < 30; ++seed) {
        const image::Mask in = noise(45, 31, 0.3 + 0.015 * seed, seed);
        for (const int min_area_px : {0, 2, 7, 40}) {
            for (const int max_hole_px : {0, 3, 25}) {
                image::Mask mask = in;
                test::remove_small_parts(mask, min_area_px, max_hole_px, scratch);
                EXPECT_EQ(mask.data, without_small_parts(in, min_area_px, max_hole_px).data)
                    << seed << ", " << min_area_px << ", " << max_hole_px;
            }
        }
    }
}

TEST(CleanMask, KeepsPlainMasks) {
    CleanScratch scratch;
    for (const std::uint8_t value : {std::uint8_t{0}, std::uint8_t{255}}) {
        image::Mask mask(20, 10, value);
        test::remove_small_parts(mask, 50, 50, scratch);
        EXPECT_EQ(mask.data, image::Mask(20, 10, value).data);
    }
}

}  // namespace
}  // namespace atrium::segmentation
