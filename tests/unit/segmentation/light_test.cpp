#include "site_node/segmentation/segmentation.hpp"
#include "tests/support/skips.hpp"
#include "tests/unit/segmentation/test_room.hpp"

namespace atrium::segmentation {
namespace {

using namespace test;

image::YuvImage lit(const image::YuvImage& scene, double light, std::mt19937& random) {
    image::YuvImage frame = scene;
    scale_light(frame, kWhole, light);
    add_noise(frame, 1.5, 0.7, random);
    return frame;
}

// A person of another hue, as bright as the room.
void stand(image::YuvImage& frame) {
    for (int y = kPatch.y / 2; y < (kPatch.y + kPatch.height) / 2; ++y) {
        for (int x = kPatch.x / 2; x < (kPatch.x + kPatch.width) / 2; ++x) frame.v.row(y)[x] += 40;
    }
}

TEST(Light, CompensatesFlickerOfTheWholeRoom) {
    std::mt19937 random(1);
    const image::YuvImage scene = room(240, 160);
    const auto learned = learn(scene, 20, random);
    SegmentationOptions still;
    still.max_gain_change = 0.0;
    still.drift_frames = 0.0;
    Segmenter compensating(learned, {});
    Segmenter uncompensated(learned, still);
    image::Mask mask;
    double seen_without = 0.0;
    for (const double light : {1.0, 1.22, 0.8, 1.15, 0.9, 1.2}) {
        // a shadow in this light is darker than any shadow in the learned light
        image::YuvImage frame = lit(scene, light, random);
        scale_light(frame, kPatch, 0.7);
        ASSERT_TRUE(compensating.segment(frame, mask).has_value());
        EXPECT_EQ(foreground_part(mask, kWhole), 0.0) << light;
        ASSERT_TRUE(uncompensated.segment(frame, mask).has_value());
        seen_without += foreground_part(mask, kWhole);
    }
    EXPECT_GT(seen_without, 1.0);
}

TEST(Light, BoundsCompensationAndStillFindsPeople) {
    std::mt19937 random(2);
    const image::YuvImage scene = room(240, 160);
    const auto learned = learn(scene, 20, random);
    LightAdaptation light;
    const BackgroundModel model = make_model(learned, {});
    const auto gain = [&](double factor) {
        const image::YuvImage frame = lit(scene, factor, random);
        image::WorkingPicture picture{image::YuvView(frame)};
        return static_cast<double>(light.inverse_gain(picture, model, {})) / kUnitGain;
    };
    EXPECT_NEAR(gain(1.1), 1.0 / 1.1, 0.004);
    EXPECT_NEAR(gain(0.85), 1.0 / 0.85, 0.004);
    EXPECT_EQ(gain(1.0), 1.0);
    EXPECT_NEAR(gain(0.5), 1.0 / 0.75, 0.001);
    EXPECT_NEAR(gain(1.6), 1.0 / 1.25, 0.02);  // a part of the room clips

    Segmenter segmenter(learned, {});
    image::Mask mask;
    for (const double factor : {1.15, 0.85}) {
        image::YuvImage frame = lit(scene, factor, random);
        stand(frame);
        ASSERT_TRUE(segmenter.segment(frame, mask).has_value());
        EXPECT_EQ(foreground_part(mask, kPatchCore), 1.0);
        EXPECT_NEAR(foreground_part(mask, kWhole) * kWhole.width * kWhole.height,
                    kPatch.width * kPatch.height,
                    60.0);
    }
}

TEST(Light, FollowsLocalDriftOfTheLight) {
    std::mt19937 random(3);
    const image::YuvImage scene = room(240, 160);
    const auto learned = learn(scene, 20, random);
    const image::PixelRect window{120, 0, 120, 160};  // half of the room
    SegmentationOptions options;
    options.drift_frames = 150.0;
    Segmenter following(learned, options);
    options.drift_frames = 0.0;
    options.max_gain_change = 0.0;
    Segmenter fixed(learned, options);
    image::Mask mask;
    const auto drifted = [&](double light) {
        image::YuvImage frame = scene;
        scale_light(frame, window, light);
        add_noise(frame, 1.5, 0.7, random);
        return frame;
    };
    for (int i = 0; i <= 1500; ++i) {
        ASSERT_TRUE(following.segment(drifted(1.0 - 0.2 * i / 1500), mask).has_value());
        ASSERT_EQ(foreground_part(mask, kWhole), 0.0) << i;
    }
    // a shadow in that light: only a model that followed knows it
    image::YuvImage frame = drifted(0.8);
    scale_light(frame, {140, 40, 60, 60}, 0.68);
    ASSERT_TRUE(following.segment(frame, mask).has_value());
    EXPECT_EQ(foreground_part(mask, kWhole), 0.0);
    ASSERT_TRUE(fixed.segment(frame, mask).has_value());
    EXPECT_GT(foreground_part(mask, {144, 44, 52, 52}), 0.9);
}

TEST(Light, BoundsDrift) {
    const image::YuvImage scene = plain(96, 64, {100, 120, 130});
    std::mt19937 random(4);
    SegmentationOptions options;
    options.drift_frames = 32.0;
    options.max_drift = 12.0;
    options.max_gain_change = 0.0;
    Segmenter segmenter(learn(scene, 5, random, 0.5), options);
    image::Mask mask;
    for (int i = 0; i < 3000; ++i) {
        image::YuvImage frame = scene;
        const auto up = static_cast<std::uint8_t>(std::min(i / 40, 60));
        for (std::uint8_t& y : frame.y.data) y = static_cast<std::uint8_t>(y + up);
        ASSERT_TRUE(segmenter.segment(frame, mask).has_value());
    }
    const BackgroundModel& model = segmenter.model();
    for (std::size_t i = 0; i < model.luma.size(); ++i) {
        const double moved = (model.luma[i] - model.room.luma[i]) / 256.0;
        EXPECT_LE(moved, 12.01);
        EXPECT_GT(moved, 6.0);  // as far as the model recognised the room
    }
}

TEST(Light, NeverAbsorbsAPersonIntoTheRoom) {
    std::mt19937 random(5);
    const image::YuvImage scene = room(240, 160);
    SegmentationOptions options;
    options.drift_frames = 40.0;
    const auto learned = learn(scene, 20, random);
    Segmenter segmenter(learned, options);
    image::Mask mask;
    for (int i = 0; i < 600; ++i) {
        image::YuvImage frame = lit(scene, 1.0, random);
        stand(frame);
        ASSERT_TRUE(segmenter.segment(frame, mask).has_value());
        ASSERT_EQ(foreground_part(mask, kPatchCore), 1.0) << i;
    }
    const BackgroundModel& model = segmenter.model();
    for (int y = kPatch.y; y < kPatch.y + kPatch.height; ++y) {
        for (int x = kPatch.x; x < kPatch.x + kPatch.width; ++x) {
            const auto pixel = static_cast<std::size_t>(y * 240 + x);
            ASSERT_EQ(model.luma[pixel], model.room.luma[pixel]) << x << ", " << y;
        }
    }
}

TEST(Light, FollowsEquallyForAllInstructionSets) {
    if (best_instruction_set() == InstructionSet::kBaseline)
        GTEST_SKIP() << atrium::test::skip::kNoAvx2;
    std::mt19937 random(9);
    const auto number = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    int num_changed = 0;
    for (int round = 0; round < 40; ++round) {
        const int width = 2 * number(1, 130);
        const int height = 2 * number(1, 9);
        const image::YuvImage scene = room(width, height);
        SegmentationOptions options;
        options.drift_frames = number(2, 50);
        options.max_drift = number(0, 60);
        BackgroundModel baseline = make_model(learn(scene, 5, random), options);
        const std::vector<std::uint16_t> learned = baseline.luma;
        BackgroundModel avx2 = baseline;
        LightAdaptation baseline_light;
        LightAdaptation avx2_light;
        image::SparseMask people{.mask = image::Mask(width, height), .rows = {}};
        people.forget();
        people.mask.row(number(0, height - 1))[number(0, width - 1)] = round % 2 == 0 ? 255 : 0;
        for (int i = 0; i < 12; ++i) {
            image::YuvImage frame = scene;
            for (image::Plane* plane : {&frame.y, &frame.u, &frame.v}) {
                for (std::uint8_t& value : plane->data) {
                    // some pixels clip, and some are no background
                    const int changed = number(0, 9) == 0 ? number(0, 255) : value + number(-6, 6);
                    value = static_cast<std::uint8_t>(std::clamp(changed, 0, 255));
                }
            }
            image::WorkingPicture picture(frame);
            baseline_light.follow(picture, people, options, baseline, InstructionSet::kBaseline);
            avx2_light.follow(picture, people, options, avx2, InstructionSet::kAvx2);
        }
        for (std::size_t pixel = 0; pixel < learned.size(); ++pixel)
            num_changed += baseline.luma[pixel] != learned[pixel] ? 1 : 0;
        ASSERT_EQ(baseline.luma, avx2.luma) << width << "x" << height;
        ASSERT_EQ(baseline.u, avx2.u);
        ASSERT_EQ(baseline.v, avx2.v);
        ASSERT_TRUE(baseline.looks == avx2.looks);
    }
    EXPECT_GT(num_changed, 1000);
}

}  // namespace
}  // namespace atrium::segmentation
