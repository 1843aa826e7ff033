#include "core/image/raw_image.hpp"

#include "tests/support/pictures/bgr_from_yuv.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

namespace atrium::image {
namespace {

constexpr int kOddWidth = 13;  // the last column and row belong to no block
constexpr int kOddHeight = 7;
constexpr std::size_t kPadding = 5;

struct Rgb {
    int r = 0;
    int g = 0;
    int b = 0;
};

/// One colour per 2x2 block, which every format can represent.
struct Scene {
    std::vector<Rgb> blocks;
    const Rgb& at(int x, int y) const {
        return blocks[static_cast<std::size_t>(y / 2 * ((kOddWidth + 1) / 2) + x / 2)];
    }
};

Scene random_scene(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> byte(0, 255);
    Scene scene;
    for (int i = 0; i < (kOddWidth + 1) / 2 * ((kOddHeight + 1) / 2); ++i)
        scene.blocks.push_back({byte(random), byte(random), byte(random)});
    return scene;
}

int luma(const Rgb& c) { return static_cast<int>(0.299 * c.r + 0.587 * c.g + 0.114 * c.b + 0.5); }
int u_of(const Rgb& c) {
    return std::min(static_cast<int>(128.5 - 0.168736 * c.r - 0.331264 * c.g + 0.5 * c.b), 255);
}
int v_of(const Rgb& c) {
    return std::min(static_cast<int>(128.5 + 0.5 * c.r - 0.418688 * c.g - 0.081312 * c.b), 255);
}

// `block` holds the colours of the first row, then those of the second. It is one array, because
// g++ 12 with -fsanitize=undefined mixes up the elements of two literals that a condition chooses
// from.
int mosaic_sample(const Rgb& c, const std::array<char, 4>& block, int x, int y) {
    const char colour = block[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
    return colour == 'R' ? c.r : colour == 'G' ? c.g : c.b;
}

std::vector<std::uint8_t> encode(const Scene& scene, PixelFormat format, std::size_t stride) {
    std::vector<std::uint8_t> bytes(stride * kOddHeight, 0xaa);
    for (int y = 0; y < kOddHeight; ++y) {
        std::uint8_t* row = bytes.data() + static_cast<std::size_t>(y) * stride;
        for (int x = 0; x < kOddWidth; ++x) {
            const Rgb& c = scene.at(x, y);
            const auto put = [&](int at, int value) { row[at] = static_cast<std::uint8_t>(value); };
            const int chroma = x % 2 == 0 ? u_of(c) : v_of(c);
            switch (format) {
                case PixelFormat::kRgb:
                    put(3 * x, c.r), put(3 * x + 1, c.g), put(3 * x + 2, c.b);
                    break;
                case PixelFormat::kBgr:
                    put(3 * x, c.b), put(3 * x + 1, c.g), put(3 * x + 2, c.r);
                    break;
                case PixelFormat::kUyvy:
                    put(2 * x, chroma), put(2 * x + 1, luma(c));
                    break;
                case PixelFormat::kYuyv:
                    put(2 * x, luma(c)), put(2 * x + 1, chroma);
                    break;
                case PixelFormat::kBayerRG:
                    put(x, mosaic_sample(c, {'R', 'G', 'G', 'B'}, x, y));
                    break;
                case PixelFormat::kBayerGR:
                    put(x, mosaic_sample(c, {'G', 'R', 'B', 'G'}, x, y));
                    break;
                case PixelFormat::kBayerGB:
                    put(x, mosaic_sample(c, {'G', 'B', 'R', 'G'}, x, y));
                    break;
                case PixelFormat::kBayerBG:
                    put(x, mosaic_sample(c, {'B', 'G', 'G', 'R'}, x, y));
                    break;
                default:
                    put(x, luma(c));
            }
        }
    }
    return bytes;
}

RawImage raw_image(const std::vector<std::uint8_t>& bytes, PixelFormat format, std::size_t stride) {
    RawImage raw;
    raw.format = format;
    raw.width = kOddWidth;
    raw.height = kOddHeight;
    raw.planes[0] = {bytes.data(), stride};
    return raw;
}

TEST(WorkingView, EveryColourFormatShowsTheSameColours) {
    for (const PixelFormat format : {PixelFormat::kRgb,
                                     PixelFormat::kBgr,
                                     PixelFormat::kUyvy,
                                     PixelFormat::kYuyv,
                                     PixelFormat::kBayerRG,
                                     PixelFormat::kBayerGR,
                                     PixelFormat::kBayerGB,
                                     PixelFormat::kBayerBG}) {
        SCOPED_TRACE(static_cast<int>(format));
        YuvImage buffer;
        for (unsigned seed = 0; seed < 20; ++seed) {
            const Scene scene = random_scene(seed);
            const std::size_t stride = row_bytes(format, kOddWidth) + kPadding;
            const std::vector<std::uint8_t> bytes = encode(scene, format, stride);
            const YuvView view = working_view(raw_image(bytes, format, stride), buffer);
            ASSERT_EQ(view.width(), kOddWidth - 1);
            ASSERT_EQ(view.height(), kOddHeight - 1);
            ASSERT_EQ(view.mosaic, mosaic_of(format));
            const std::vector<std::uint8_t> bgr = test::bgr_from_yuv(view);
            for (int y = 0; y < view.height(); ++y) {
                for (int x = 0; x < view.width(); ++x) {
                    const Rgb& c = scene.at(x, y);
                    EXPECT_NEAR(view.u.at(x / 2, y / 2), u_of(c), 1);
                    EXPECT_NEAR(view.v.at(x / 2, y / 2), v_of(c), 1);
                    const std::uint8_t* p =
                        &bgr[static_cast<std::size_t>(3 * (y * view.width() + x))];
                    EXPECT_NEAR(p[0], c.b, 4);
                    EXPECT_NEAR(p[1], c.g, 4);
                    EXPECT_NEAR(p[2], c.r, 4);
                }
            }
        }
    }
}

TEST(WorkingPicture, PartsEqualTheWhole) {
    for (const PixelFormat format : {PixelFormat::kRgb,
                                     PixelFormat::kBgr,
                                     PixelFormat::kUyvy,
                                     PixelFormat::kYuyv,
                                     PixelFormat::kBayerGB,
                                     PixelFormat::kMono8}) {
        SCOPED_TRACE(static_cast<int>(format));
        const std::size_t stride = row_bytes(format, kOddWidth) + kPadding;
        const std::vector<std::uint8_t> bytes = encode(random_scene(3), format, stride);
        const RawImage raw = raw_image(bytes, format, stride);
        YuvImage whole_buffer;
        const YuvView whole = working_view(raw, whole_buffer);
        YuvImage buffer;
        WorkingPicture picture(raw, buffer);
        picture.make({4, 2, 2, 2});  // some places are read before their rows are made
        EXPECT_EQ(picture.view().y.at(5, 3), whole.y.at(5, 3));
        EXPECT_EQ(picture.view().u.at(2, 1), whole.u.at(2, 1));
        picture.make({0, 0, 8, 6});
        picture.make({8, 0, 4, 4});
        picture.make({8, 4, 4, 2});
        const YuvView& parts = picture.view();
        EXPECT_EQ(parts.mosaic, whole.mosaic);
        for (int y = 0; y < whole.height(); ++y) {
            for (int x = 0; x < whole.width(); ++x) {
                EXPECT_EQ(parts.y.at(x, y), whole.y.at(x, y));
                EXPECT_EQ(parts.u.at(x / 2, y / 2), whole.u.at(x / 2, y / 2));
                EXPECT_EQ(parts.v.at(x / 2, y / 2), whole.v.at(x / 2, y / 2));
            }
        }
    }
}

TEST(WorkingView, MonochromeHasNoHue) {
    const Scene scene = random_scene(5);
    const std::vector<std::uint8_t> bytes = encode(scene, PixelFormat::kMono8, kOddWidth);
    YuvImage buffer;
    buffer.u =
        Plane((kOddWidth - 1) / 2, (kOddHeight - 1) / 2, 7);  // leftover of an earlier picture
    const YuvView view = working_view(raw_image(bytes, PixelFormat::kMono8, kOddWidth), buffer);
    EXPECT_EQ(view.y.data, bytes.data());
    EXPECT_EQ(view.y.at(4, 4), luma(scene.at(4, 4)));
    for (int y = 0; y < view.u.height; ++y) {
        for (int x = 0; x < view.u.width; ++x) {
            EXPECT_EQ(view.u.at(x, y), 128);
            EXPECT_EQ(view.v.at(x, y), 128);
        }
    }
}

TEST(WorkingView, UsableFormatsAreNotCopied) {
    const auto image =
        std::make_shared<const YuvImage>(YuvImage{Plane(6, 4, 1), Plane(3, 2, 2), Plane(3, 2, 3)});
    YuvImage buffer;
    const YuvView view = working_view(RawImage(image), buffer);
    EXPECT_EQ(view.y.data, image->y.data.data());
    EXPECT_EQ(view.u.data, image->u.data.data());
    EXPECT_EQ(view.v.data, image->v.data.data());
    EXPECT_EQ(image.use_count(), 1);  // the temporary has released its reference
    const std::vector<std::uint8_t> bytes(kOddWidth * kOddHeight, 9);
    const RawImage mosaic = raw_image(bytes, PixelFormat::kBayerGB, kOddWidth);
    EXPECT_EQ(working_view(mosaic, buffer).y.data, bytes.data());
}

TEST(RawImage, IsEmptyWithoutAPicture) {
    EXPECT_TRUE(RawImage().empty());
    EXPECT_TRUE(RawImage(nullptr).empty());
}

}  // namespace
}  // namespace atrium::image
