#include "site_node/segmentation/bit_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <utility>

namespace atrium::segmentation {
namespace {

// Blobs of random sizes, also at the edges of the picture.
image::SparseMask random_mask(int width, int height, std::mt19937& random) {
    image::SparseMask mask;
    mask.mask = image::Mask(width, height);
    mask.forget();
    const auto below = [&](int limit) {
        return static_cast<int>(random() % static_cast<unsigned>(limit));
    };
    for (int i = 1 + below(6); i > 0; --i) {
        const int x = below(width + 10) - 10;
        const int y = below(height + 10) - 10;
        const int right = std::min(x + 1 + below(40), width);
        const int bottom = std::min(y + 1 + below(30), height);
        for (int line = std::max(y, 0); line < bottom; ++line) {
            for (int column = std::max(x, 0); column < right; ++column)
                mask.mask.row(line)[column] = random() % 8 == 0 ? 0 : 255;
        }
    }
    // spans as narrow as they can be
    for (int y = 0; y < height; ++y) {
        image::PixelSpan& span = mask.rows[static_cast<std::size_t>(y)];
        const std::uint8_t* const row = mask.mask.row(y);
        while (span.begin < span.end && row[span.begin] == 0) ++span.begin;
        while (span.begin < span.end && row[span.end - 1] == 0) --span.end;
        if (span.begin == span.end) span = {0, 0};
    }
    return mask;
}

bool at(const image::Mask& mask, int x, int y) {
    return mask.at(std::clamp(x, 0, mask.width - 1), std::clamp(y, 0, mask.height - 1)) != 0;
}

bool at(const BitRows& rows, int x, int y) {
    const int word = x / 64 - rows.first_word;
    if (y < rows.first_row || y >= rows.end_row() || word < 0 || word >= rows.num_words)
        return false;
    return (rows.row(y)[word] >> (x % 64) & 1) != 0;
}

image::Mask mask_of(const image::Mask& in, const std::function<bool(int, int)>& is_set) {
    image::Mask out(in.width, in.height);
    for (int y = 0; y < in.height; ++y) {
        for (int x = 0; x < in.width; ++x) out.row(y)[x] = is_set(x, y) ? 255 : 0;
    }
    return out;
}

void expect_same(const BitRows& rows, const image::Mask& expected) {
    for (int y = 0; y < expected.height; ++y) {
        for (int x = 0; x < expected.width; ++x)
            ASSERT_EQ(at(rows, x, y), expected.at(x, y) != 0) << x << ", " << y;
    }
}

TEST(BitRows, DoTheSameAsPixelByPixel) {
    std::mt19937 random(3);
    for (const auto& [width, height] : {std::pair{200, 60}, {64, 64}, {130, 38}, {30, 22}}) {
        for (int round = 0; round < 40; ++round) {
            const image::SparseMask mask = random_mask(width, height, random);
            BitRows people, eroded, dilated, all;
            if (!pack(mask, 4, people)) {
                EXPECT_EQ(std::ranges::count(mask.mask.data, 0),
                          static_cast<long>(mask.mask.data.size()));
                continue;
            }
            expect_same(people, mask.mask);
            EXPECT_EQ(people.first_row % 4, 0);
            const auto cross = [&](const image::Mask& in, bool both) {
                return mask_of(in, [&](int x, int y) {
                    int num = 0;
                    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                        num += at(in, x + dx, y + dy) ? 1 : 0;
                    return both ? num == 5 : num > 0;
                });
            };
            erode(people, eroded);
            expect_same(eroded, cross(mask.mask, true));
            dilate(people, dilated);
            expect_same(dilated, cross(mask.mask, false));
            // twice: what lies beyond the edges has to be right as well
            const image::Mask wide = cross(mask.mask, false);
            dilate(dilated, all);
            expect_same(all, cross(wide, false));

            BitRows most;
            majority(people, eroded, most);
            const image::Mask core = cross(mask.mask, true);
            expect_same(most, mask_of(mask.mask, [&](int x, int y) {
                            if (core.at(x, y) == 0) return at(mask.mask, x, y);
                            int num = 0;
                            for (int dy = -1; dy <= 1; ++dy) {
                                for (int dx = -1; dx <= 1; ++dx)
                                    num += at(mask.mask, x + dx, y + dy) ? 1 : 0;
                            }
                            return num >= 5;
                        }));
            majority(people, dilated, most);
            expect_same(most, mask_of(mask.mask, [&](int x, int y) {
                            if (wide.at(x, y) == 0) return at(mask.mask, x, y);
                            int num = 0;
                            for (int dy = -1; dy <= 1; ++dy) {
                                for (int dx = -1; dx <= 1; ++dx)
                                    num += at(mask.mask, x + dx, y + dy) ? 1 : 0;
                            }
                            return num >= 5;
                        }));
            for (int y = people.first_row; y + 4 <= people.end_row(); y += 4) {
                for (int x = 0; x + 4 <= width; x += 4) {
                    const unsigned tile = people.tile<4>(y, x);
                    for (int i = 0; i < 16; ++i)
                        ASSERT_EQ((tile >> i & 1) != 0, at(mask.mask, x + i % 4, y + i / 4));
                }
            }
        }
    }
}

}  // namespace
}  // namespace atrium::segmentation
