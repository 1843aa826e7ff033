#include "site_node/refine/luma_picture.hpp"

#include "tests/support/random.hpp"
#include "tests/support/skips.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace atrium::refine {
namespace {

struct Scene {
    image::YuvImage picture{image::Plane(62, 40), image::Plane(31, 20), image::Plane(31, 20)};
    image::Mask mask{62, 40};

    explicit Scene(std::uint64_t seed) {
        test::Random random(seed);
        for (std::uint8_t& value : picture.y.data)
            value = static_cast<std::uint8_t>(test::between(random, 0, 255));
        for (int y = 6; y < 33; ++y) {
            for (int x = 9; x < 51; ++x)
                mask.row(y)[x] = test::between(random, 0, 60) > 0 ? 255 : 0;
        }
    }
    PictureView view() const { return {nullptr, picture, &mask, {9, 6, 42, 27}}; }
};

TEST(LumaPicture, HasTheMeansOfBlocksAndTheirNeighbours) {
    const Scene scene(3);
    LumaScratch scratch;
    LumaPicture luma;
    fill(scene.view(), scratch, luma);
    ASSERT_EQ(luma.first_x, 4);
    ASSERT_EQ(luma.first_y, 3);
    ASSERT_EQ(luma.width, 22);   // columns 8 to 51
    ASSERT_EQ(luma.height, 14);  // rows 6 to 33
    const auto mean = [&](int x, int y) {
        const int left = 2 * (luma.first_x + std::min(x, luma.width - 1));
        const int top = 2 * (luma.first_y + std::min(y, luma.height - 1));
        const image::Plane& of = scene.picture.y;
        return (of.at(left, top) + of.at(left + 1, top) + of.at(left, top + 1) +
                of.at(left + 1, top + 1) + 2) /
               4;
    };
    for (int y = 0; y < luma.height; ++y) {
        for (int x = 0; x < luma.width; ++x) {
            const std::uint32_t taps = luma.taps[static_cast<std::size_t>(y * luma.width + x)];
            EXPECT_EQ(static_cast<int>(taps & 255U), mean(x, y));
            EXPECT_EQ(static_cast<int>((taps >> 8U) & 255U), mean(x + 1, y));
            EXPECT_EQ(static_cast<int>((taps >> 16U) & 255U), mean(x, y + 1));
            EXPECT_EQ(static_cast<int>(taps >> 24U), mean(x + 1, y + 1));
        }
    }
    const Eigen::Vector2f place = luma.place({8.5, 6.5});  // the middle of the first block
    EXPECT_EQ(place, Eigen::Vector2f::Zero());
}

TEST(LumaPicture, IsInsideOnlyFarFromBackground) {
    const Scene scene(4);
    LumaScratch scratch;
    LumaPicture luma;
    fill(scene.view(), scratch, luma);
    int num_inside = 0;
    for (int y = 0; y < luma.height; ++y) {
        for (int x = 0; x < luma.width; ++x) {
            bool expected = true;
            for (int by = y - 2; by <= y + 2; ++by) {
                for (int bx = x - 2; bx <= x + 2; ++bx) {
                    if (bx < 0 || by < 0 || bx >= luma.width || by >= luma.height) {
                        expected = false;
                        continue;
                    }
                    for (const int k : {0, 1, 2, 3})
                        expected &= scene.mask.at(2 * (luma.first_x + bx) + (k & 1),
                                                  2 * (luma.first_y + by) + (k >> 1)) != 0;
                }
            }
            EXPECT_EQ(luma.inside[static_cast<std::size_t>(y * luma.width + x)] != 0, expected)
                << x << " " << y;
            num_inside += expected ? 1 : 0;
        }
    }
    EXPECT_GT(num_inside, 0);
}

TEST(LumaPicture, IsEmptyWithoutPictureMaskOrSubject) {
    const Scene scene(5);
    LumaScratch scratch;
    LumaPicture luma;
    fill(scene.view(), scratch, luma);
    ASSERT_GT(luma.width, 0);
    for (const int missing : {0, 1, 2}) {
        PictureView view = scene.view();
        if (missing == 0) view.picture = {};
        if (missing == 1) view.mask = nullptr;
        if (missing == 2) view.subject = {};
        fill(view, scratch, luma);
        EXPECT_EQ(luma.width, 0) << missing;
        EXPECT_TRUE(luma.taps.empty()) << missing;
    }
}

TEST(LumaPicture, IsTheSameForAllInstructionSets) {
    if (image::best_row_code() != image::RowCode::kAvx2) GTEST_SKIP() << test::skip::kNoAvx2;
    const Scene scene(6);
    LumaScratch scratch;
    LumaPicture baseline, fast;
    fill(scene.view(), scratch, baseline, image::RowCode::kBaseline);
    fill(scene.view(), scratch, fast, image::RowCode::kAvx2);
    EXPECT_EQ(baseline.taps, fast.taps);
    EXPECT_EQ(baseline.inside, fast.inside);
}

}  // namespace
}  // namespace atrium::refine
