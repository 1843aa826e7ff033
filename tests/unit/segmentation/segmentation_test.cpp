#include "site_node/segmentation/segmentation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::segmentation {
namespace {

using testing::HasSubstr;

struct Colour {
    double y, u, v;
};

image::YuvImage plain(int width, int height, Colour c) {
    const auto byte = [](double value) {
        return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    };
    return {image::Plane(width, height, byte(c.y)),
            image::Plane(width / 2, height / 2, byte(c.u)),
            image::Plane(width / 2, height / 2, byte(c.v))};
}

// Smooth colours over the whole range that a lit wall has.
image::YuvImage room(int width, int height) {
    image::YuvImage frame = plain(width, height, {0, 128, 128});
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x)
            frame.y.row(y)[x] = static_cast<std::uint8_t>(70 + 130 * x / width);
    }
    for (int y = 0; y < height / 2; ++y) {
        for (int x = 0; x < width / 2; ++x) {
            const double luma = frame.y.at(2 * x, 2 * y);
            frame.u.row(y)[x] =
                static_cast<std::uint8_t>(std::lround(128 + luma * (0.3 * y / height - 0.1)));
            frame.v.row(y)[x] = static_cast<std::uint8_t>(std::lround(128 - luma * 0.15));
        }
    }
    return frame;
}

void add_noise(image::YuvImage& frame,
               double sigma_luma,
               double sigma_chroma,
               std::mt19937& random) {
    const auto shake = [&](image::Plane& plane, double sigma) {
        std::normal_distribution<double> noise(0.0, sigma);
        for (std::uint8_t& value : plane.data) {
            value =
                static_cast<std::uint8_t>(std::clamp(std::lround(value + noise(random)), 0L, 255L));
        }
    };
    shake(frame.y, sigma_luma);
    shake(frame.u, sigma_chroma);
    shake(frame.v, sigma_chroma);
}

// Multiplies the light in a rectangle with even edges.
void scale_light(image::YuvImage& frame, const image::PixelRect& area, double factor) {
    for (int y = area.y; y < area.y + area.height; ++y) {
        for (int x = area.x; x < area.x + area.width; ++x) {
            std::uint8_t& luma = frame.y.row(y)[x];
            luma = static_cast<std::uint8_t>(std::min(255L, std::lround(factor * luma)));
        }
    }
    for (image::Plane* plane : {&frame.u, &frame.v}) {
        for (int y = area.y / 2; y < (area.y + area.height) / 2; ++y) {
            for (int x = area.x / 2; x < (area.x + area.width) / 2; ++x) {
                std::uint8_t& chroma = plane->row(y)[x];
                chroma = static_cast<std::uint8_t>(std::lround(128 + factor * (chroma - 128)));
            }
        }
    }
}

BackgroundModel learn(const image::YuvImage& scene,
                      int num_frames,
                      std::mt19937& random,
                      double sigma = 2.0) {
    BackgroundLearner learner;
    for (int i = 0; i < num_frames; ++i) {
        image::YuvImage frame = scene;
        add_noise(frame, sigma, 0.5 * sigma, random);
        EXPECT_TRUE(learner.add(frame).has_value());
    }
    return learner.finish({}).value();
}

image::Mask segmented(const image::YuvImage& frame, const BackgroundModel& model) {
    SegmentationScratch scratch;
    image::Mask mask;
    EXPECT_TRUE(segment(frame, model, {}, scratch, mask).has_value());
    return mask;
}

// Part of the pixels of `area` that are foreground.
double foreground_part(const image::Mask& mask, const image::PixelRect& area) {
    double count = 0;
    for (int y = area.y; y < area.y + area.height; ++y) {
        for (int x = area.x; x < area.x + area.width; ++x) count += mask.at(x, y) != 0;
    }
    return count / (area.width * area.height);
}

constexpr image::PixelRect kPatch{60, 40, 80, 60};
constexpr image::PixelRect kPatchCore{64, 44, 72, 52};
constexpr image::PixelRect kWhole{0, 0, 240, 160};

TEST(BackgroundLearner, SaysWhyItCannotLearn) {
    BackgroundLearner learner;
    EXPECT_THAT(learner.finish({}).error().message, HasSubstr("no picture"));
    image::YuvImage odd = plain(8, 8, {1, 2, 3});
    odd.u = image::Plane(3, 4);
    EXPECT_THAT(learner.add(odd).error().message, HasSubstr("4:2:0"));
    EXPECT_THAT(learner.add(image::YuvImage{}).error().message, HasSubstr("4:2:0"));
    ASSERT_TRUE(learner.add(plain(8, 8, {1, 2, 3})).has_value());
    EXPECT_THAT(learner.add(plain(8, 10, {1, 2, 3})).error().message, HasSubstr("8x8, then 8x10"));
    EXPECT_EQ(learner.num_frames(), 1);
}

TEST(Segmentation, RejectsAFrameOfAnotherSize) {
    std::mt19937 random(1);
    const BackgroundModel model = learn(room(240, 160), 2, random);
    SegmentationScratch scratch;
    image::Mask mask;
    const auto result = segment(room(160, 160), model, {}, scratch, mask);
    ASSERT_FALSE(result.has_value());
    EXPECT_THAT(result.error().message, HasSubstr("160x160"));
}

TEST(Segmentation, TheEmptyRoomIsEmptyAfterOneFrameAndAfterMany) {
    for (const int num_frames : {1, 30}) {
        std::mt19937 random(2);
        const image::YuvImage scene = room(240, 160);
        const BackgroundModel model = learn(scene, num_frames, random);
        for (int i = 0; i < 5; ++i) {
            image::YuvImage frame = scene;
            add_noise(frame, 2.0, 1.0, random);
            EXPECT_EQ(foreground_part(segmented(frame, model), kWhole), 0.0)
                << num_frames << " frames";
        }
    }
}

TEST(Segmentation, ShadowsAndHighlightsAreBackground) {
    std::mt19937 random(3);
    const image::YuvImage scene = room(240, 160);
    const BackgroundModel model = learn(scene, 20, random);
    for (const double light : {0.65, 0.75, 0.9, 1.08}) {
        image::YuvImage frame = scene;
        scale_light(frame, kPatch, light);
        add_noise(frame, 2.0, 1.0, random);
        EXPECT_EQ(foreground_part(segmented(frame, model), kWhole), 0.0) << "light " << light;
    }
}

TEST(Segmentation, AWholeRoomThatGetsALittleDarkerStaysEmpty) {
    std::mt19937 random(4);
    const image::YuvImage scene = room(240, 160);
    const BackgroundModel model = learn(scene, 20, random);
    image::YuvImage frame = scene;
    scale_light(frame, kWhole, 0.85);
    add_noise(frame, 2.0, 1.0, random);
    EXPECT_EQ(foreground_part(segmented(frame, model), kWhole), 0.0);
}

TEST(Segmentation, FindsWhatDiffersInHueOrIsTooDarkOrTooBright) {
    std::mt19937 random(5);
    const image::YuvImage scene = room(240, 160);
    const BackgroundModel model = learn(scene, 20, random);
    // same luma, other hue
    image::YuvImage hue = scene;
    for (int y = kPatch.y / 2; y < (kPatch.y + kPatch.height) / 2; ++y) {
        for (int x = kPatch.x / 2; x < (kPatch.x + kPatch.width) / 2; ++x) hue.v.row(y)[x] += 40;
    }
    image::YuvImage dark = scene;
    scale_light(dark, kPatch, 0.35);
    image::YuvImage bright = scene;
    scale_light(bright, kPatch, 1.5);
    for (image::YuvImage* frame : {&hue, &dark, &bright}) {
        add_noise(*frame, 2.0, 1.0, random);
        const image::Mask mask = segmented(*frame, model);
        EXPECT_EQ(foreground_part(mask, kPatchCore), 1.0);
        const double all = foreground_part(mask, kWhole) * kWhole.width * kWhole.height;
        EXPECT_NEAR(all,
                    kPatch.width * kPatch.height,
                    40.0);  // corners, rounded by the majority, and some noise
    }
}

TEST(Segmentation, ClippedAndBlackSurfacesDoNotFlicker) {
    std::mt19937 random(6);
    for (const Colour colour : {Colour{255, 128, 128}, Colour{4, 128, 128}, Colour{12, 126, 131}}) {
        const image::YuvImage scene = plain(240, 160, colour);
        const BackgroundModel model = learn(scene, 1, random);
        image::YuvImage frame = scene;
        add_noise(frame, 2.5, 2.0, random);
        EXPECT_EQ(foreground_part(segmented(frame, model), kWhole), 0.0) << colour.y;
        for (int y = kPatch.y; y < kPatch.y + kPatch.height; ++y)
            std::fill_n(frame.y.row(y) + kPatch.x, kPatch.width, 120);
        EXPECT_EQ(foreground_part(segmented(frame, model), kPatchCore), 1.0) << colour.y;
    }
}

TEST(PixelTest, AllInstructionSetsGiveTheSameBits) {
    if (best_instruction_set() == InstructionSet::kBaseline)
        GTEST_SKIP() << "this processor has no AVX2";
    std::mt19937 random(7);
    std::uniform_int_distribution<int> byte(0, 255);
    std::uniform_int_distribution<int> word(-32767, 32767);
    PixelTestScratch scratch;
    for (const int width : {2, 30, 34, 66, 640}) {
        image::YuvImage frame = plain(width, 22, {0, 0, 0});
        for (image::Plane* plane : {&frame.y, &frame.u, &frame.v}) {
            for (std::uint8_t& value : plane->data) value = static_cast<std::uint8_t>(byte(random));
        }
        BackgroundModel model;
        model.width = width;
        model.height = 22;
        model.max_distance_sq = 40000000;
        for (auto* plane : {&model.luma_low, &model.luma_high}) {
            plane->resize(frame.y.data.size());
            for (std::uint8_t& value : *plane) value = static_cast<std::uint8_t>(byte(random));
        }
        for (auto* plane :
             {&model.ratio_u, &model.ratio_v, &model.whiten_u, &model.whiten_uv, &model.whiten_v}) {
            plane->resize(frame.u.data.size());
            for (std::int16_t& value : *plane) value = static_cast<std::int16_t>(word(random));
        }
        image::Mask baseline(width, 22, 1);
        image::Mask avx2(width, 22, 2);
        test_pixels(frame, model, InstructionSet::kBaseline, scratch, baseline);
        test_pixels(frame, model, InstructionSet::kAvx2, scratch, avx2);
        EXPECT_EQ(baseline.data, avx2.data) << width;
    }
}

}  // namespace
}  // namespace atrium::segmentation
