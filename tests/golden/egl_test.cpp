#include "core/gl/egl_context.hpp"
#include "core/gl/offscreen_context.hpp"
#include "tests/golden/golden_file.hpp"
#include "tests/golden/golden_scenes.hpp"
#include "tests/support/skips.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <thread>

// Draws in EGL contexts: on a GPU if there is one, otherwise in software, with a driver of its own.
namespace atrium::golden {
namespace {

using gl::EglContext;
using gl::EglDevices;
using renderer::RenderedPicture;

// Limits for a GPU. Its driver may move a pixel of an edge to the other side, and blends texels of
// a distant floor differently. They are below an object that moves by two pixels. Nobody has
// measured them on a GPU yet. softpipe, a rasteriser of Mesa that shares nothing with llvmpipe,
// stays within the limits of the same driver: mean 0.1, nothing over 5.
constexpr Limits kOtherDriver{.mean = 1.0, .percentile_99_9 = 10.0, .share_over_5 = 0.005};
// No standard defines the pixels of a line: softpipe has 8 % over 5.
constexpr Limits kLinesOfOtherDriver{
    .mean = 3.0, .percentile_99_9 = std::numeric_limits<double>::infinity(), .share_over_5 = 0.15};

Limits limits_of(const EglContext& context, const Scene& scene) {
    if (!context.is_hardware()) return {};
    return scene.name == "debug_view" ? kLinesOfOtherDriver : kOtherDriver;
}

RenderedPicture drawn(const Scene& scene) {
    auto picture = draw(scene);
    EXPECT_TRUE(picture) << picture.error().message;
    return picture ? std::move(*picture) : RenderedPicture{};
}

class Egl : public testing::Test {
protected:
    // Empty, with the reason, if the machine has no EGL device.
    std::optional<EglContext> open() {
        auto context = EglContext::create(EglDevices::kAny);
        if (!context) {
            reason_ = context.error().message;
            return std::nullopt;
        }
        return std::move(*context);
    }
    std::string reason_;
};

class EglPicture : public Egl, public testing::WithParamInterface<Scene> {};

// Several contexts in one process, one after the other, and back again.
TEST_P(EglPicture, EqualsThatOfOsmesa) {
    RenderedPicture of_osmesa;
    RenderedPicture of_egl;
    Limits limits;
    {
        const auto context = gl::OffscreenContext::create(16, 16);
        ASSERT_TRUE(context) << context.error().message;
        of_osmesa = drawn(GetParam());
    }
    {
        const auto context = open();
        if (!context) GTEST_SKIP() << atrium::test::skip::kNoEgl << reason_;
        limits = limits_of(*context, GetParam());
        of_egl = drawn(GetParam());
    }
    const PictureDifference difference = picture_difference(of_osmesa, of_egl);
    EXPECT_TRUE(is_within(difference, limits)) << describe(difference);
    expect_golden(GetParam().name, of_egl, limits);
    const auto context = gl::OffscreenContext::create(16, 16);
    ASSERT_TRUE(context) << context.error().message;
    EXPECT_EQ(drawn(GetParam()).rgba, of_osmesa.rgba);
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         EglPicture,
                         testing::ValuesIn(all_scenes()),
                         [](const auto& scene) { return scene.param.name; });

TEST_F(Egl, ContextCanMoveToAnotherThread) {
    auto context = open();
    if (!context) GTEST_SKIP() << atrium::test::skip::kNoEgl << reason_;
    const Scene scene = all_scenes().front();
    const RenderedPicture here = drawn(scene);
    context->release();
    RenderedPicture there;
    std::jthread([&] {
        const auto current = context->make_current();
        EXPECT_TRUE(current) << current.error().message;
        there = drawn(scene);
        context->release();
    }).join();
    EXPECT_EQ(there.rgba, here.rgba);
    EXPECT_TRUE(context->make_current());
}

// Both contexts share one display.
TEST_F(Egl, ContextOutlivesAnother) {
    auto first = open();
    if (!first) GTEST_SKIP() << atrium::test::skip::kNoEgl << reason_;
    const Scene scene = all_scenes().front();
    const RenderedPicture before = drawn(scene);
    auto second = open();
    ASSERT_TRUE(second) << reason_;
    EXPECT_EQ(drawn(scene).rgba, before.rgba);
    second.reset();
    const auto current = first->make_current();
    ASSERT_TRUE(current) << current.error().message;
    EXPECT_EQ(drawn(scene).rgba, before.rgba);
    *first = std::move(*open());
    EXPECT_EQ(drawn(scene).rgba, before.rgba) << "moved";
}

TEST_F(Egl, HardwareRequestGivesHardwareOrTheReason) {
    const auto context = EglContext::create(EglDevices::kHardware);
    if (context)
        EXPECT_TRUE(context->is_hardware());
    else
        EXPECT_THAT(context.error().message, testing::StartsWith("EGL: "));
}

}  // namespace
}  // namespace atrium::golden
