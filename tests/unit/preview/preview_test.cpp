#include "site_node/preview/preview.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace atrium::preview {
namespace {

namespace fs = std::filesystem;

using Bgr = std::array<int, 3>;
constexpr Bgr kSomeColour{60, 120, 180};

// A picture of one colour, as a sensor with `format` delivers it.
image::RawImage plain_picture(int width, int height, image::PixelFormat format) {
    const bool mosaic = format == image::PixelFormat::kBayerRG;
    const std::size_t stride = image::row_bytes(format, width);
    auto bytes =
        std::make_shared<std::vector<std::uint8_t>>(stride * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            std::uint8_t* row = bytes->data() + static_cast<std::size_t>(y) * stride;
            if (mosaic) {
                row[x] = static_cast<std::uint8_t>(
                    kSomeColour[static_cast<std::size_t>(2 - (x & 1) - (y & 1))]);
                continue;
            }
            for (int c = 0; c < 3; ++c)
                row[3 * x + c] =
                    static_cast<std::uint8_t>(kSomeColour[static_cast<std::size_t>(c)]);
        }
    }
    image::RawImage raw;
    raw.format = format;
    raw.width = width;
    raw.height = height;
    raw.planes[0] = {bytes->data(), stride};
    raw.owner = std::move(bytes);
    return raw;
}

View view_of(image::PixelFormat format) {
    View view;
    view.name = "front";
    view.image = plain_picture(640, 480, format);
    // a square with a hole
    view.outlines_px = {{{99.5, 99.5}, {299.5, 99.5}, {299.5, 299.5}, {99.5, 299.5}},
                        {{159.5, 159.5}, {159.5, 239.5}, {239.5, 239.5}, {239.5, 159.5}}};
    return view;
}

Bgr pixel(const Picture& picture, int x, int y) {
    const std::size_t at = (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                            static_cast<std::size_t>(x)) *
                           3;
    return {picture.bgr[at], picture.bgr[at + 1], picture.bgr[at + 2]};
}

int difference(const Bgr& a, const Bgr& b) {
    int sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += std::abs(a[c] - b[c]);
    return sum;
}

// Where the only view of a preview begins, in x and y.
constexpr int kEdge = 4;

TEST(PreviewPicture, TintsOnlyTheSilhouette) {
    for (const auto format : {image::PixelFormat::kBgr, image::PixelFormat::kBayerRG}) {
        Picture picture;
        draw({view_of(format)}, picture);
        ASSERT_GE(picture.width, 320);
        ASSERT_GE(picture.height, 240);
        const Bgr outside = pixel(picture, kEdge + 20, kEdge + 20);
        EXPECT_LE(difference(outside, kSomeColour), 9);
        EXPECT_EQ(pixel(picture, kEdge + 100, kEdge + 100), outside);  // in the hole
        const Bgr inside = pixel(picture, kEdge + 65, kEdge + 65);
        EXPECT_GT(inside[1], outside[1] + 20);  // greener
        EXPECT_LT(inside[2], outside[2] - 20);
        // the outline runs through pixel 49.5 of the halved picture
        const Bgr border = pixel(picture, kEdge + 50, kEdge + 100);
        EXPECT_GT(border[1], inside[1] + 20);
        EXPECT_EQ(pixel(picture, kEdge + 47, kEdge + 100), outside);
        EXPECT_EQ(pixel(picture, kEdge + 53, kEdge + 100), inside);
    }
}

TEST(PreviewPicture, ChangesTheBrightnessAndEncirclesMarks) {
    View view = view_of(image::PixelFormat::kBgr);
    view.outlines_px.clear();
    view.brightness = 0.5;
    view.caption = "what it needs";
    view.marks_px = {{200.5, 300.5}};
    Picture picture;
    draw({view}, picture);
    const Bgr plain = pixel(picture, kEdge + 100, kEdge + 150);  // in the middle of the circle
    EXPECT_LE(difference(plain, {30, 60, 90}), 9);
    EXPECT_GT(difference(pixel(picture, kEdge + 106, kEdge + 150), plain), 150);
    EXPECT_EQ(pixel(picture, kEdge + 112, kEdge + 150), plain);
}

TEST(PreviewPicture, HasACellForEveryCameraEvenIfLost) {
    for (std::size_t n = 1; n <= 12; ++n) {
        std::vector<View> views(n, view_of(image::PixelFormat::kBgr));
        views[n / 2] = {};
        views[n / 2].name = "gone";
        Picture picture;
        draw(views, picture);
        int num_shown = 0;
        int num_gone = 0;
        for (int y = kEdge; y + 240 < picture.height; y += 240 + 26 + kEdge) {
            for (int x = kEdge; x + 320 < picture.width; x += 320 + kEdge) {
                num_shown += difference(pixel(picture, x + 10, y + 10), kSomeColour) < 10;
                num_gone += pixel(picture, x + 10, y + 10) == Bgr{60, 60, 60};
            }
        }
        EXPECT_EQ(num_shown, static_cast<int>(n) - 1);
        EXPECT_EQ(num_gone, 1);
    }
}

TEST(Preview, ForegroundIsTheAreaInsideTheOutlines) {
    EXPECT_DOUBLE_EQ(enclosed_area_px(view_of(image::PixelFormat::kBgr).outlines_px),
                     200.0 * 200.0 - 80.0 * 80.0);
    EXPECT_EQ(enclosed_area_px({}), 0.0);
}

class PreviewFile : public testing::Test {
protected:
    void TearDown() override { fs::remove_all(folder_); }
    const fs::path folder_ =
        fs::path(testing::TempDir()) / ("atrium_preview_" + std::to_string(getpid()));
};

TEST_F(PreviewFile, IsWrittenCompletelyWithoutLeftovers) {
    const fs::path file = folder_ / "new" / "views.png";
    const View view = view_of(image::PixelFormat::kBgr);
    capture::Metaframe metaframe;
    metaframe.frames.resize(2);
    metaframe.frames[0].image = view.image;
    metaframe.frames[1].camera = 1;
    {
        Preview preview(file, {"front", "gone"});
        EXPECT_TRUE(preview.count(metaframe));
        preview.show(metaframe, {view.outlines_px, {}});
        EXPECT_FALSE(preview.count(metaframe));  // false for one second
    }                                            // the destructor still writes the pending picture
    Picture drawn;
    draw({view, {}}, drawn);
    const cv::Mat read = cv::imread(file.string());
    ASSERT_FALSE(read.empty());
    EXPECT_EQ(read.cols, drawn.width);
    EXPECT_EQ(read.rows, drawn.height);
    EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1);
}

TEST_F(PreviewFile, NamesTheReasonOfAWriteError) {
    Picture picture;
    draw({}, picture);
    const auto written = write_png("/proc/no/such/place.png", picture);
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message, testing::HasSubstr("/proc/no/such/place.png"));
}

}  // namespace
}  // namespace atrium::preview
