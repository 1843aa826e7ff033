#include "core/gl/egl_context.hpp"
#include "core/gl/offscreen_context.hpp"
#include "tests/golden/golden_file.hpp"
#include "tests/golden/golden_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <thread>

// The renderer in contexts of EGL: on a GPU where there is one, else in software, which has a
// driver of its own there.
namespace atrium::golden {
namespace {

using gl::EglContext;
using gl::EglDevices;
using renderer::RenderedPicture;

// Of a GPU, whose driver may put a pixel of an edge on the other side, and blends the texels of a
// floor far away otherwise. Less than a thing that moves by two pixels. Nobody has measured it on a
// GPU yet; softpipe, a rasteriser of Mesa's that shares nothing with llvmpipe, stays within the
// limits of the same driver: mean 0.1, nothing over 5.
constexpr Limits kOtherDriver{.mean = 1.0, .percentile_99_9 = 10.0, .share_over_5 = 0.005};
// Which pixels a line covers is not laid down: softpipe has 8 % over 5.
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
    // Nothing, with the reason, where the machine has no device for EGL at all.
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

// One after the other in one process, and back again.
TEST_P(EglPicture, IsThatOfOsmesa) {
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
        if (!context) GTEST_SKIP() << reason_;
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

TEST_F(Egl, AContextCanBeHandedToAnotherThread) {
    auto context = open();
    if (!context) GTEST_SKIP() << reason_;
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

// They have one display.
TEST_F(Egl, AContextOutlivesAnotherOne) {
    auto first = open();
    if (!first) GTEST_SKIP() << reason_;
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
    EXPECT_EQ(drawn(scene).rgba, before.rgba) << "moved to";
}

TEST_F(Egl, WhoWantsHardwareGetsHardwareOrTheReason) {
    const auto context = EglContext::create(EglDevices::kHardware);
    if (context)
        EXPECT_TRUE(context->is_hardware());
    else
        EXPECT_THAT(context.error().message, testing::StartsWith("EGL: "));
}

}  // namespace
}  // namespace atrium::golden
