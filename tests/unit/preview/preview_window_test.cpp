#include "site_node/preview/preview_window.hpp"

#include "site_node/preview/preview.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/virtual_display.hpp"

#include <gtest/gtest.h>

// Shows the preview window on a private display and reads the display's pixels.
namespace atrium::preview {
namespace {

using test_support::comes_true;
using test_support::VirtualDisplay;
using Colour = VirtualDisplay::Colour;
using Size = VirtualDisplay::Size;

constexpr const char* kTitle = "a window under test";
constexpr Colour kBlack{0, 0, 0};
constexpr Colour kRed{200, 30, 20};
constexpr Colour kBlue{10, 40, 220};

// The upper half red, the lower half blue.
Picture two_colours(int width, int height) {
    Picture picture;
    picture.width = width;
    picture.height = height;
    for (int y = 0; y < height; ++y) {
        const Colour& colour = 2 * y < height ? kRed : kBlue;
        for (int x = 0; x < width; ++x) {
            for (int c = 2; c >= 0; --c)
                picture.bgr.push_back(
                    static_cast<std::uint8_t>(colour[static_cast<std::size_t>(c)]));
        }
    }
    return picture;
}

class PreviewWindowTest : public testing::Test {
protected:
    void SetUp() override {
        auto started = VirtualDisplay::start(1280, 800);
        if (!started) GTEST_SKIP() << atrium::test::skip::kNoDisplay << started.error().message;
        display_ = std::move(*started);
    }

    std::unique_ptr<VirtualDisplay> display_;
};

TEST_F(PreviewWindowTest, ShowsThePictureUprightAtItsSize) {
    auto window = PreviewWindow::open(kTitle);
    ASSERT_TRUE(window) << window.error().message;
    const Picture picture = two_colours(401, 300);  // rows of an odd number of bytes
    EXPECT_TRUE(comes_true([&] {
        (*window)->show(picture);
        return (*window)->stays_open() && display_->size_of(kTitle) == Size{401, 300} &&
               display_->colour_in(kTitle, 5, 5) == kRed &&
               display_->colour_in(kTitle, 395, 140) == kRed &&
               display_->colour_in(kTitle, 5, 160) == kBlue &&
               display_->colour_in(kTitle, 395, 295) == kBlue;
    }));
}

// As that of eight cameras of 1 MP.
TEST_F(PreviewWindowTest, IsNotLargerThanTheScreen) {
    auto window = PreviewWindow::open(kTitle);
    ASSERT_TRUE(window) << window.error().message;
    const Picture picture = two_colours(1536, 1600);
    EXPECT_TRUE(comes_true([&] {
        (*window)->show(picture);
        return (*window)->stays_open() && display_->size_of(kTitle) == Size{691, 720} &&
               display_->colour_in(kTitle, 5, 5) == kRed &&
               display_->colour_in(kTitle, 685, 715) == kBlue;
    }));
}

TEST_F(PreviewWindowTest, KeepsThePicturesAspectRatioInAnyWindow) {
    auto window = PreviewWindow::open(kTitle);
    ASSERT_TRUE(window) << window.error().message;
    const Picture picture = two_colours(400, 300);
    (*window)->show(picture);
    ASSERT_TRUE((*window)->stays_open());
    display_->resize(kTitle, {1000, 600});  // the picture is then 800 x 600 and begins at x = 100
    EXPECT_TRUE(comes_true([&] {
        (*window)->show(picture);
        return (*window)->stays_open() && display_->colour_in(kTitle, 95, 20) == kBlack &&
               display_->colour_in(kTitle, 105, 20) == kRed &&
               display_->colour_in(kTitle, 895, 580) == kBlue &&
               display_->colour_in(kTitle, 905, 580) == kBlack;
    }));
    EXPECT_EQ(display_->size_of(kTitle), (Size{1000, 600}));
}

TEST_F(PreviewWindowTest, EscapeAndTheFrameCloseIt) {
    for (const auto ask : {&VirtualDisplay::press_escape, &VirtualDisplay::ask_to_close}) {
        auto window = PreviewWindow::open(kTitle);
        ASSERT_TRUE(window) << window.error().message;
        (*window)->show(two_colours(400, 300));
        EXPECT_TRUE((*window)->stays_open());
        (display_.get()->*ask)(kTitle);
        EXPECT_TRUE(comes_true([&] { return !(*window)->stays_open(); }));
        window->reset();
        EXPECT_TRUE(comes_true([&] { return !display_->size_of(kTitle); }));
    }
}

TEST_F(PreviewWindowTest, RequestsNoPicturesAfterItsEnd) {
    constexpr const char* kPreviewTitle = "Atrium: views of the site";
    auto bytes = std::make_shared<std::vector<std::uint8_t>>(640 * 480, std::uint8_t{200});
    capture::Metaframe metaframe;
    metaframe.frames.resize(1);
    image::RawImage& image = metaframe.frames[0].image;
    image.format = image::PixelFormat::kMono8;
    image.width = 640;
    image.height = 480;
    image.planes[0] = {bytes->data(), 640};
    image.owner = bytes;
    Preview preview(kWindow, {"front"});
    const auto offer = [&] {
        const bool is_wanted = preview.count(metaframe);
        if (is_wanted) preview.show(metaframe, {{}});
        return is_wanted;
    };
    EXPECT_TRUE(comes_true([&] {
        offer();
        const auto colour = display_->colour_in(kPreviewTitle, 100, 100);
        return colour && (*colour)[0] > 150 && (*colour)[1] > 150 && (*colour)[2] > 150;
    }));
    display_->press_escape(kPreviewTitle);
    EXPECT_TRUE(comes_true([&] {
        offer();
        return !display_->size_of(kPreviewTitle);
    }));
    EXPECT_TRUE(comes_true([&] { return !offer(); }));
    for (int i = 0; i < 100; ++i) EXPECT_FALSE(offer());
}

}  // namespace
}  // namespace atrium::preview
